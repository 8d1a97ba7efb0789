//! What a goal asks besides poses, coordinates and constraints, against the end of the path: what is near, what lies where, what hands
//! hold, and that no hand is left around what was not asked for.
//!
//! All of it is measured at the last knot: a hand may have reached its grasp by a motion that leads to it.

use crate::check::contract::scene_contract::Contract;
use crate::check::leaf::footing::footing;
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::world::documents::Frames;
use crate::check::world::models::{Link, corners, normal};
use crate::path_file::document::{PathFile, SurfaceEntry};
use foliate_components::problem::{Holding, JointRest, OtherHands, PartialGoal};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, PartIndex, PartKind, Source};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Where a gripper and a handle are so near to a grasp there is one, metres and radians.
const GRASPED: f64 = 1e-4;
/// What is so near to rest on a support rests there, metres and radians: surely, so half of what planners take for it.
const RESTS: f64 = 5e-5;
/// Rounding of what is asked in numbers.
const SLACK: f64 = 1e-9;

/// The end of a path.
pub(super) struct End<'e> {
    pub file: &'e PathFile,
    pub motion: &'e SegmentMotion<'e>,
    pub frames: &'e Frames,
    /// The last knot, in the order of the problem's coordinates.
    pub last: &'e [f64],
}

impl Contract<'_> {
    /// What a goal asks in vain at the end of a path.
    pub(super) fn unmet(&self, goal: &PartialGoal, end: &End<'_>) -> Option<String> {
        let robot = &self.problem.robot;
        if let Some(&(index, value, tolerance)) = goal.near.iter().find(|asked| !self.is_near(asked, end.last)) {
            return Some(format!("{}, {} instead of {value} within {tolerance},", self.names[index], end.last[index]));
        }
        if let Some((part, _)) = goal.lying.iter().find(|(part, supports)| {
            let is_one = |name: &String| supports.iter().any(|support| robot.surfaces[support.at()].name == *name);
            !lies_on(&robot[*part].name, end, &is_one)
        }) {
            return Some(format!("{} on its support", robot[*part].name));
        }
        let grasps = self.grasped(end);
        for &(gripper, handle) in &grasps {
            if !self.is_asked(goal, gripper, handle, end) {
                let (hand, held) = (&robot.grippers[gripper.at()].name, &robot.handles[handle.at()].name);
                return Some(format!("{hand}, which is left around {held},"));
            }
        }
        let holds = |gripper: GripperIndex, fits: &dyn Fn(HandleIndex) -> bool| {
            grasps.iter().any(|&(g, handle)| g == gripper && fits(handle))
        };
        let missing = goal.hands.iter().find(|&&(gripper, holding)| match holding {
            Holding::Nothing | Holding::Anything => false,
            Holding::Object(part) => !holds(gripper, &|handle| self.owner(handle) == part),
            Holding::Handle(wanted) => !holds(gripper, &|handle| handle == wanted),
        });
        if let Some((gripper, _)) = missing {
            return Some(format!("what {} holds", robot.grippers[gripper.at()].name));
        }
        let held = |part: &&PartIndex| !grasps.iter().any(|&(_, handle)| self.owner(handle) == **part);
        goal.held.iter().find(held).map(|part| format!("{}, which no hand holds,", robot[*part].name))
    }

    fn is_near(&self, &(index, value, tolerance): &(usize, f64, f64), last: &[f64]) -> bool {
        let space = &self.problem.robot.space;
        let off = last[index] - value;
        let endless = !space.lower[index].is_finite() && !space.upper[index].is_finite();
        let off = if endless { off - TAU * (off / TAU).round() } else { off };
        off.abs() <= tolerance + SLACK
    }

    fn owner(&self, handle: HandleIndex) -> PartIndex {
        let robot = &self.problem.robot;
        robot.links[robot.handles[handle.at()].link.at()].part
    }

    /// The grasps of the scene that there are at the end.
    fn grasped(&self, end: &End<'_>) -> Vec<(GripperIndex, HandleIndex)> {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let mut grasped = Vec::new();
        for &gripper in &options.grippers {
            for &handle in options.objects.iter().flat_map(|object| &object.handles) {
                let may = options.grasps.as_ref().is_none_or(|grasps| grasps.contains(&(gripper, handle)));
                let hand = end.frames.grippers.get(&robot.grippers[gripper.at()].name);
                let held = end.frames.handles.get(&robot.handles[handle.at()].name);
                let (true, Some((_, hand)), Some((_, held))) = (may, hand, held) else { continue };
                let at = At::knot(end.motion.last());
                let pose = end.motion.frame(hand, at).inverse() * end.motion.frame(held, at);
                let mask = robot.handles[handle.at()].mask;
                if off_rows(pose.translation, pose.rotation, mask) <= GRASPED {
                    grasped.push((gripper, handle));
                }
            }
        }
        grasped
    }

    /// Whether a goal asks for a grasp, or does not mind it.
    fn is_asked(&self, goal: &PartialGoal, gripper: GripperIndex, handle: HandleIndex, end: &End<'_>) -> bool {
        let (robot, object) = (&self.problem.robot, self.owner(handle));
        if let Some((_, holding)) = goal.hands.iter().find(|(named, _)| *named == gripper) {
            return match holding {
                Holding::Nothing => false,
                Holding::Anything => true,
                Holding::Object(part) => *part == object,
                Holding::Handle(wanted) => *wanted == handle,
            };
        }
        let of = robot.links[robot.grippers[gripper.at()].link.at()].part;
        robot[of].kind != PartKind::Robot
            || goal.other_hands == OtherHands::Anything
            || goal.held.contains(&object)
            || self.gives_a_place(goal, object) && !self.rests(object, end)
    }

    /// Whether a goal says where an object is.
    fn gives_a_place(&self, goal: &PartialGoal, part: PartIndex) -> bool {
        let joints = &self.problem.robot.joints;
        let of_part = |joint: JointIndex| joints[joint.at()].part == part;
        let owns = |index: usize| {
            joints.iter().filter(|joint| joint.part == part).any(|joint| {
                let Source::Coordinates { q, .. } = joint.source else { return false };
                (q..q + joint.motion.configuration_size()).contains(&index)
            })
        };
        goal.poses.iter().any(|(named, _)| *named == part)
            || goal.coordinates.iter().any(|(index, _)| owns(*index))
            || goal.near.iter().any(|(index, ..)| owns(*index))
            || goal.constraints.iter().any(|named| named.constraint.bodies().into_iter().flatten().any(of_part))
    }

    /// Whether an object surely rests without a hand where the path has it in the end.
    fn rests(&self, part: PartIndex, end: &End<'_>) -> bool {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let Some(object) = options.objects.iter().find(|object| object.part == part) else { return false };
        if !end.motion.world.part(&robot[part].name).is_some_and(|part| end.motion.world.parts[part].floats) {
            return options.resting_joints.iter().all(|resting| {
                let JointRest::At(value) = resting.rest else { return true };
                let joint = &robot.joints[resting.joint.at()];
                let Source::Coordinates { q, .. } = joint.source else { return true };
                joint.part != part || (end.last[q] - value).abs() <= RESTS
            });
        }
        if let Some(plane) = &object.plane {
            let Some(root) = end.motion.world.part(&robot[part].name).and_then(|part| {
                let world = end.motion.world;
                world.link(&world.parts[part].root_link, String::new).ok()
            }) else {
                return false;
            };
            let pose = plane.world_from_plane.inverse()
                * end.motion.frame(&root.frame, At::knot(end.motion.last()))
                * plane.object_from_frame;
            let tilt = (pose.rotation * DVec3::Z).cross(DVec3::Z).length();
            return pose.translation.z.abs() <= RESTS && tilt <= RESTS;
        }
        if object.surfaces.is_empty() {
            return true;
        }
        lies_on(&robot[part].name, end, &|name: &String| {
            robot.surface(name).is_some_and(|surface| options.supports.contains(&surface))
        })
    }
}

/// The largest row of a mask that a pose is off.
fn off_rows(translation: DVec3, rotation: DQuat, mask: [bool; 6]) -> f64 {
    let way = (0..3).filter(|&row| mask[row]).map(|row| translation[row].abs()).fold(0.0, f64::max);
    let turn = match [mask[3], mask[4], mask[5]] {
        [false, false, false] => 0.0,
        [false, true, true] => off_axis(rotation, DVec3::X),
        [true, false, true] => off_axis(rotation, DVec3::Y),
        [true, true, false] => off_axis(rotation, DVec3::Z),
        _ => 2.0 * DVec3::new(rotation.x, rotation.y, rotation.z).length().atan2(rotation.w.abs()),
    };
    way.max(turn)
}

/// How far an axis is turned away from itself, radians.
fn off_axis(rotation: DQuat, axis: DVec3) -> f64 {
    let turned = rotation * axis;
    turned.cross(axis).length().atan2(turned.dot(axis))
}

/// Whether a surface of a part lies on one of the supports at the end: at the margin, flat, and over it as the rule asks.
fn lies_on(part: &str, end: &End<'_>, is_one: &dyn Fn(&String) -> bool) -> bool {
    let documents = &end.file.documents.surfaces;
    let of_part = |link: &str| link.split_once('/').is_some_and(|(owner, _)| owner == part);
    let lying = documents.iter().filter(|(_, surface)| of_part(&surface.link));
    let mut pairs = lying.flat_map(|lying| {
        let supports = documents.iter().filter(move |(name, support)| is_one(name) && !of_part(&support.link));
        supports.map(move |support| (lying, support))
    });
    pairs.any(|((lower, surface), (upper, support))| {
        let links = (end.frames.surfaces.get(lower), end.frames.surfaces.get(upper));
        let (Some(held), Some(carrier)) = links else { return false };
        touches(end, (held, surface), (carrier, support))
    })
}

fn touches(end: &End<'_>, (held, surface): (&Link, &SurfaceEntry), (carrier, support): (&Link, &SurfaceEntry)) -> bool {
    let at = At::knot(end.motion.last());
    let pose = end.motion.frame(&carrier.frame, at).inverse() * end.motion.frame(&held.frame, at);
    let mean = |corners: &[DVec3]| corners.iter().sum::<DVec3>() / corners.len() as f64;
    support.polygons.iter().map(|polygon| corners(support, polygon)).any(|below| {
        let Some(up) = normal(&below) else { return false };
        surface.polygons.iter().map(|polygon| corners(surface, polygon)).any(|above| {
            let Some(down) = normal(&above) else { return false };
            let (world, rests) = (end.motion.world, end.file.rests);
            let Some(footing) = footing(world, held, rests, (&above, down), 0.0) else { return false };
            let height = up.dot(pose.transform_point(mean(&above)) - mean(&below)) - end.file.placement_margin;
            let edges = below.iter().zip(below.iter().cycle().skip(1));
            let mut sides = edges.filter_map(|(a, b)| Some(((*b - *a).cross(up).try_normalize()?, *a)));
            let is_over = sides.all(|(out, corner)| {
                let beyond = |point: &DVec3| out.dot(pose.transform_point(*point) - corner);
                footing.points.iter().all(|(_, point)| beyond(point) <= RESTS - footing.margin)
            });
            (pose.rotation * down).distance(-up) <= RESTS && height.abs() <= RESTS && is_over
        })
    })
}
