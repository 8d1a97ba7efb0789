//! Forward kinematics of many configurations at once, over a table that is resolved when the robot is loaded.
//!
//! What a joint does to its body is found then: about which axis of its frame it turns, how it is mounted on its parent
//! (mostly by quarter turns, which only exchange columns), whose coordinate moves it. What remains in the loop is a few dozen
//! multiplications a joint and one branch that always goes the same way.

use crate::kinematics::lane_steps::{LaneStep, POSE_ROWS, Parent};
use crate::lanes::geometry::Transform;
use crate::lanes::level::{Kernel, Level};
use crate::lanes::vector::{F32Row, F64Row, Isa, Lanes};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, Robot};

/// The tables of forward kinematics in lanes: all bodies of a robot, or those between the world and one of them.
#[derive(Clone, Debug, PartialEq)]
pub struct LaneKinematics {
    steps: Vec<LaneStep>,
    /// For each step its body.
    bodies: Vec<JointIndex>,
    size: usize,
}

impl LaneKinematics {
    /// All bodies, in the robot's order.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let all = (0..robot.joints.len()).map(|joint| JointIndex(joint as u32)).collect();
        Self::of_bodies(robot, all)
    }

    /// The bodies to which one is attached, and itself, in this order.
    #[must_use]
    pub fn chain_to(robot: &Robot, tip: JointIndex) -> Self {
        let mut bodies: Vec<_> = std::iter::successors(Some(tip), |&j| robot.joints[j.at()].parent).collect();
        bodies.reverse();
        Self::of_bodies(robot, bodies)
    }

    /// Parents come first, and all of them are there.
    fn of_bodies(robot: &Robot, bodies: Vec<JointIndex>) -> Self {
        let parent = |step: usize| match robot.joints[bodies[step].at()].parent {
            None => Parent::World,
            Some(parent) => match bodies.iter().position(|&b| b == parent) {
                Some(at) if at + 1 == step => Parent::Previous,
                Some(at) => Parent::Body(at),
                None => Parent::World, // not reached: every body's parent is among them
            },
        };
        let step =
            |(index, body): (usize, &JointIndex)| LaneStep::of_joint(robot, &robot.joints[body.at()], parent(index));
        let steps = bodies.iter().enumerate().map(step).collect();
        Self { steps, bodies, size: robot.space.size() }
    }

    /// The bodies whose poses are found, in this order.
    #[must_use]
    pub fn bodies(&self) -> &[JointIndex] {
        &self.bodies
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_size(&self) -> usize {
        self.size
    }

    /// Poses of all bodies in the world, for use within a kernel: `q` one row per coordinate, `out` [`POSE_ROWS`] rows per
    /// body of [`Self::bodies`].
    ///
    /// # Panics
    /// If a slice is too short.
    #[inline(always)]
    pub fn forward_in<V: Lanes>(&self, isa: V::Isa, q: &[V::Row], out: &mut [V::Row]) {
        run::<V>(isa, &self.steps, q, &[], out);
    }

    /// Poses of all bodies in the world for blocks of eight configurations: `q` holds [`Self::configuration_size`] rows per
    /// block, `out` [`POSE_ROWS`] rows per body and block.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn forward_f64(&self, level: Level, q: &[F64Row], out: &mut [F64Row]) {
        level.run(ForwardF64 { table: self, q, out });
    }

    /// As [`Self::forward_f64`], for blocks of sixteen in single precision.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn forward_f32(&self, level: Level, q: &[F32Row], out: &mut [F32Row]) {
        level.run(ForwardF32 { table: self, q, out });
    }
}

struct ForwardF64<'a> {
    table: &'a LaneKinematics,
    q: &'a [F64Row],
    out: &'a mut [F64Row],
}

impl Kernel for ForwardF64<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        blocks::<I::F64>(isa, self.table, self.q, self.out);
    }
}

struct ForwardF32<'a> {
    table: &'a LaneKinematics,
    q: &'a [F32Row],
    out: &'a mut [F32Row],
}

impl Kernel for ForwardF32<'_> {
    type Output = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        blocks::<I::F32>(isa, self.table, self.q, self.out);
    }
}

#[inline(always)]
fn blocks<V: Lanes>(isa: V::Isa, table: &LaneKinematics, q: &[V::Row], out: &mut [V::Row]) {
    let poses = table.steps.len() * POSE_ROWS;
    if table.size == 0 || poses == 0 {
        return;
    }
    for (q, out) in q.chunks_exact(table.size).zip(out.chunks_exact_mut(poses)) {
        table.forward_in::<V>(isa, q, out);
    }
}

/// Fills the poses of the steps' bodies, [`POSE_ROWS`] rows each. `given` are poses that steps refer to.
#[inline(always)]
pub(crate) fn run<V: Lanes>(isa: V::Isa, steps: &[LaneStep], q: &[V::Row], given: &[V::Row], out: &mut [V::Row]) {
    let mut body = Transform::<V>::splat(isa, &Pose::identity());
    for (index, step) in steps.iter().enumerate() {
        let from = match step.parent {
            Parent::World => None,
            Parent::Previous => Some(body),
            Parent::Body(at) => Some(Transform::load(isa, &out[at * POSE_ROWS..])),
            Parent::Given(at) => Some(Transform::load(isa, &given[at * POSE_ROWS..])),
        };
        body = match from {
            None => step.moved(isa, step.mounted_on_world(isa), q, given),
            Some(from) if step.is_inverse => step.unmounted(isa, &step.moved(isa, from, q, given)),
            Some(from) => step.moved(isa, step.mounted(isa, &from), q, given),
        };
        body.store(&mut out[index * POSE_ROWS..]);
    }
}
