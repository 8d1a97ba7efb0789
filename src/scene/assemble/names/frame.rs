//! Frames that constraints relate: on a link, or fixed in the world.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::keys::{Item, Keys};
use foliate_components::Pose;
use foliate_components::constraint::Frame;
use foliate_components::robot::{JointIndex, LinkIndex, PartIndex, Robot};
use foliate_kernels::kinematics::Kinematics;

/// What constraints are read against: the robot, and where the start has its bodies (for values that are the start's).
pub(crate) struct Context<'a> {
    pub robot: &'a Robot,
    pub start: &'a [f64],
    pub bodies: Vec<Pose>,
    pub locked: &'a [(JointIndex, f64)],
}

impl<'a> Context<'a> {
    pub fn new(robot: &'a Robot, start: &'a [f64], locked: &'a [(JointIndex, f64)]) -> Self {
        let mut bodies = vec![Pose::identity(); robot.joints.len()];
        Kinematics::new(robot).forward(start, &mut bodies);
        Self { robot, start, bodies, locked }
    }
}

/// A value, or `"start"` for the one that the start has.
pub(crate) fn or_start<T: Copy>(
    item: &Item<'_>,
    start: T,
    read: impl Fn(&Item<'_>) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    if item.is_string() { one_of(item, &[("start", start)]) } else { read(item) }
}

/// A frame, and the part that carries it.
#[derive(Clone, Copy)]
pub(crate) struct ReadFrame {
    pub frame: Frame,
    /// `None` in the world.
    pub part: Option<PartIndex>,
}

impl ReadFrame {
    /// The world's own frame.
    pub fn world() -> Self {
        Self { frame: Frame::world(Pose::identity()), part: None }
    }

    /// Where it is in the world when the bodies are there.
    pub fn in_world(&self, bodies: &[Pose]) -> Pose {
        match self.frame.joint {
            Some(joint) => bodies[joint.at()] * self.frame.joint_from_frame,
            None => self.frame.joint_from_frame,
        }
    }
}

/// `"part/link"`, or `{ link = "part/link", pose = … }`; without a link the frame is fixed in the world.
pub(crate) fn frame(item: &Item<'_>, robot: &Robot) -> Result<ReadFrame, SceneError> {
    if item.is_string() {
        return Ok(on_link(link(item, robot)?, &Pose::identity(), robot));
    }
    let mut keys = item.keys()?;
    let link = keys.optional("link").map(|item| link(&item, robot)).transpose()?;
    let pose = keys.optional("pose").map_or(Ok(Pose::identity()), |item| item.pose())?;
    keys.finish()?;
    Ok(match link {
        Some(link) => on_link(link, &pose, robot),
        None => ReadFrame { frame: Frame::world(pose), part: None },
    })
}

/// `x`, `y` and `z`, each `[lower, upper]` in metres: at least one of them.
pub(crate) fn box_bounds(keys: &mut Keys<'_>, item: &Item<'_>) -> Result<[Option<(f64, f64)>; 3], SceneError> {
    let mut axis = |key| keys.optional(key).map(|item| item.bounds()).transpose();
    let bounds = [axis("x")?, axis("y")?, axis("z")?];
    if bounds.iter().all(Option::is_none) {
        return Err(item.error("bounds nothing").hint("give `x`, `y` or `z` as [lower, upper], metres in the frame"));
    }
    Ok(bounds)
}

fn on_link(link: LinkIndex, link_from_frame: &Pose, robot: &Robot) -> ReadFrame {
    let part = Some(robot.links[link.at()].part);
    ReadFrame { frame: Frame::on_link(robot, link, link_from_frame), part }
}

/// A link by its name.
pub(crate) fn link(item: &Item<'_>, robot: &Robot) -> Result<LinkIndex, SceneError> {
    let name = item.string()?;
    let known = || robot.links.iter().map(|l| l.name.as_str());
    robot
        .link(name)
        .ok_or_else(|| item.error(format!("there is no link `{}`", quoted(name))).hint(did_you_mean(name, known())))
}

/// The value that a word stands for.
pub(crate) fn one_of<T: Copy>(item: &Item<'_>, words: &[(&'static str, T)]) -> Result<T, SceneError> {
    let word = item.string()?;
    match words.iter().find(|(w, _)| *w == word) {
        Some((_, value)) => Ok(*value),
        None => {
            let known: Vec<_> = words.iter().map(|(w, _)| *w).collect();
            let message = format!("`{}` is none of {}", quoted(word), known.join(", "));
            Err(item.error(message).hint(did_you_mean(word, known)))
        }
    }
}
