//! Problems in which something about a robot's tip holds all along: its height, its upright, its distance from the base.

use super::draw::Draw;
use super::robot::{Robot, Root};
use super::scene::Draft;
use foliate::components::pose::pose_to_array;
use glam::DVec3;

/// Draws one.
pub(super) fn kept(draft: &mut Draft, what: &mut Draw, place: &mut Draw) {
    let mut robot = Robot::with_hands(what);
    robot.root = Root::Fixed;
    draft.robot(what, &robot);
    draft.obstacles(what, place, 2, DVec3::new(0.0, 0.0, 0.7), 0.8);
    let start = robot.model.random_values(place);
    let other = robot.model.random_values(place);
    let tip = robot.tips[0];
    let link = format!("robot/{}", robot.model.links[tip].name);
    for (joint, value) in &start {
        draft.start.insert(format!("robot/{joint}"), *value);
    }
    let [x, y, z, ..] = pose_to_array(&robot.model.poses(&start)[tip]);
    let always = match what.index(4) {
        0 => "kind = \"pose\"\nvalue = \"start\"\nmask = [0, 0, 1, 0, 0, 0]".to_owned(),
        1 => "kind = \"pose\"\nvalue = \"start\"\nmask = [0, 0, 0, 1, 1, 0]".to_owned(),
        2 => format!("kind = \"distance\"\nto = \"robot/base\"\nat_most = {}", (x * x + y * y + z * z).sqrt() + 0.05),
        _ => "kind = \"distance\"\nto = \"robot/base\"\nlength = \"start\"".to_owned(),
    };
    draft.constraints += &format!("[[constraint]]\nname = \"always\"\nframe = \"{link}\"\n{always}\n");
    draft.graph = "everywhere = [\"always\"]\n".into();
    if what.chance(0.5) {
        let there = pose_to_array(&robot.model.poses(&other)[tip]);
        let mask = what.of(&["[1, 0, 0, 0, 0, 0]", "[0, 1, 0, 0, 0, 0]"]);
        draft.constraints += &format!(
            "[[constraint]]\nname = \"there\"\nkind = \"pose\"\nframe = \"{link}\"\nvalue = {{ xyz = {:?} }}\nmask = {mask}\n",
            &there[..3]
        );
        draft.goal_text = "constraints = [\"there\"]".into();
    } else if let Some((joint, value)) = other.iter().next() {
        draft.goal.insert(format!("robot/{joint}"), *value);
        draft.goal_text = format!("coordinates = {{ \"robot/{joint}\" = {value:?} }}");
    }
}
