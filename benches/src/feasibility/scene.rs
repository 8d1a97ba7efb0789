//! A problem from a few numbers: an arm, a table, boxes, and blocks that stand around them.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use foliate_components::Pose;
use foliate_components::constraint::{Grasp, Rests};
use foliate_components::pose::pose_to_array;
use foliate_components::problem::{Goal, GraphOptions, Holding, ObjectOptions, PartialGoal, Problem, Rule};
use foliate_components::robot::model::{JointKind, JointModel, LinkModel, Model};
use foliate_components::robot::shape::geometry::Geometry;
use foliate_components::robot::{PartIndex, PartPlacement, Robot};
use foliate_components::samples::models::{block, environment, fixed_robot, movable_object, seven_axis_arm, table};
use foliate_kernels::collision::adjacent_links;
use foliate_kernels::kinematics::Kinematics;
use foliate_systems::planning_model::solid_grasp;
use glam::{DQuat, DVec3};

/// Gap between what lies and what carries it, metres.
const GAP: f64 = 1e-3;

/// How far apart the jaws are when they are open, metres.
pub const OPENING: f64 = 0.08;

/// What the arm ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// A point that holds what it touches.
    Point,
    /// Two jaws that close along the y axis of a box.
    Jaws,
    /// Nothing.
    None,
}

/// Where a box stands: x and y of its middle on the table, metres, and how far it is turned, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Along the table, metres.
    pub x: f64,
    /// Aside, metres.
    pub y: f64,
    /// About the vertical, radians.
    pub turn: f64,
}

/// How the goal is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asks {
    /// A whole configuration.
    Configuration,
    /// Poses of the boxes.
    Poses,
    /// That the first box lies on the last support.
    LastSupport,
}

/// A problem in numbers.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the arm ends in.
    pub hand: Hand,
    /// Whole extents of each box, metres.
    pub boxes: Vec<DVec3>,
    /// Where each box starts.
    pub starts: Vec<Place>,
    /// Where each box shall stand.
    pub goals: Vec<Place>,
    /// How the goal is given.
    pub asks: Asks,
    /// Names of the handles of every box: `top`, `side`.
    pub handles: Vec<&'static str>,
    /// Extents and middles of blocks that never move, metres.
    pub walls: Vec<(DVec3, DVec3)>,
    /// Tables: extents, and middles of their tops, metres. Boxes may be put down on all of them.
    pub tables: Vec<(DVec3, DVec3)>,
    /// Whether the hand is empty in no state: it holds the first box at the start and in the goal, which says nothing of its place.
    pub always_held: bool,
}

impl Scene {
    /// Boxes that stand on a wide table, and shall stand elsewhere on it.
    #[must_use]
    pub fn new(boxes: Vec<DVec3>, starts: Vec<Place>, goals: Vec<Place>) -> Self {
        Self {
            hand: Hand::Point,
            boxes,
            starts,
            goals,
            asks: Asks::Poses,
            handles: vec!["top"],
            walls: Vec::new(),
            tables: vec![(DVec3::new(3.6, 3.6, 0.05), DVec3::ZERO)],
            always_held: false,
        }
    }

    /// The problem.
    ///
    /// # Panics
    /// If the numbers make no model: a bug of the generator.
    #[must_use]
    pub fn problem(&self) -> Problem {
        let arm = match self.hand {
            Hand::Point => seven_axis_arm(),
            Hand::Jaws => arm_with_jaws(),
            Hand::None => Model { grippers: Vec::new(), ..seven_axis_arm() },
        };
        let tables: Vec<_> = self.tables.iter().map(|&(size, _)| table(size)).collect();
        let walls: Vec<_> = self.walls.iter().map(|&(size, _)| block(size)).collect();
        let boxes: Vec<_> = self.boxes.iter().map(|&size| block(size)).collect();
        let at = |name: String, middle: DVec3| environment(&name, Pose::from_translation(middle));
        let mut parts: Vec<(&Model, PartPlacement)> =
            vec![(&arm, fixed_robot("arm", Pose::from_translation(DVec3::Z * 0.3)))];
        parts.extend(tables.iter().enumerate().map(|(n, model)| (model, at(format!("table{n}"), self.tables[n].1))));
        parts.extend(walls.iter().enumerate().map(|(n, model)| (model, at(format!("wall{n}"), self.walls[n].1))));
        parts.extend(boxes.iter().enumerate().map(|(n, model)| (model, movable_object(&format!("box{n}")))));
        let robot = Robot::compose(&parts).expect("the models of a generated problem fit");
        let graph = self.graph(&robot);
        let start = self.configuration(&robot, &self.starts);
        let goal = self.goal(&robot);
        let all = 0..robot.parts.len() as u32;
        let ignored_pairs = all.flat_map(|part| adjacent_links(&robot, PartIndex(part))).collect();
        Problem { graph, ignored_pairs, ..Problem::new("generated", robot, start, vec![goal]) }
    }

    fn graph(&self, robot: &Robot) -> GraphOptions {
        let object = |number: usize| {
            let name = format!("box{number}");
            let handles = self.handles.iter().filter_map(|handle| robot.handle(&format!("{name}/{handle}")));
            Some(ObjectOptions {
                part: robot.part(&name)?,
                handles: handles.collect(),
                surfaces: robot.surface(&format!("{name}/bottom")).into_iter().collect(),
                plane: None,
            })
        };
        let supports = (0..self.tables.len()).filter_map(|number| robot.surface(&format!("table{number}/top")));
        let gripper = robot.gripper("arm/hand");
        let never_empty = |gripper| {
            let rest = Rule { grasps: Vec::new(), allowed: true };
            [Rule { grasps: vec![(gripper, None)], allowed: false }, rest]
        };
        let rules = gripper.filter(|_| self.always_held).map(never_empty);
        GraphOptions {
            grippers: gripper.into_iter().collect(),
            objects: (0..self.boxes.len()).filter_map(object).collect(),
            supports: supports.collect(),
            rules: rules.into_iter().flatten().collect(),
            placement_margin: GAP,
            preplacement_distance: 0.05,
            rests: Rests::Centre,
            ..GraphOptions::default()
        }
    }

    /// The pose of a box on the table top below it.
    fn pose(&self, number: usize, place: Place) -> Pose {
        let under = self.tables.iter().rev().find(|(size, middle)| {
            (place.x - middle.x).abs() <= 0.5 * size.x && (place.y - middle.y).abs() <= 0.5 * size.y
        });
        let height = under.map_or(0.0, |(_, middle)| middle.z) + 0.5 * self.boxes[number].z + GAP;
        Pose::from_parts(DVec3::new(place.x, place.y, height), DQuat::from_rotation_z(place.turn))
    }

    fn configuration(&self, robot: &Robot, places: &[Place]) -> Vec<f64> {
        let mut q = robot.space.neutral();
        q[..7].copy_from_slice(&[0.0, -0.6, 0.0, 1.4, 0.0, 0.8, 0.0]);
        let boxes = q.len() - 7 * places.len();
        // Open jaws, where there are any.
        q[7..boxes].fill(0.5 * OPENING);
        if self.always_held {
            let kinematics = Kinematics::new(robot);
            let mut X_WJ = vec![Pose::identity(); kinematics.bodies()];
            kinematics.forward(&q, &mut X_WJ);
            let held = robot.gripper("arm/hand").zip(robot.handle("box0/top"));
            let grasp = held.and_then(|(gripper, handle)| Grasp::new(robot, gripper, handle).ok());
            let (hand, hand_from_box) = solid_grasp(&grasp.expect("the first box can be held"));
            let X_WB = hand.map_or_else(Pose::identity, |hand| X_WJ[hand.at()]) * hand_from_box;
            q[boxes..][..7].copy_from_slice(&pose_to_array(&X_WB));
        }
        for (number, &place) in places.iter().enumerate().skip(usize::from(self.always_held)) {
            q[boxes + 7 * number..][..7].copy_from_slice(&pose_to_array(&self.pose(number, place)));
        }
        q
    }

    fn goal(&self, robot: &Robot) -> Goal {
        let part = |number: usize| robot.part(&format!("box{number}"));
        let hands = robot.gripper("arm/hand").map(|gripper| (gripper, Holding::Nothing));
        match self.asks {
            Asks::Configuration => Goal::Configuration(self.configuration(robot, &self.goals)),
            Asks::Poses => {
                let poses = self.goals.iter().enumerate().skip(usize::from(self.always_held));
                let poses = poses.filter_map(|(number, &place)| Some((part(number)?, self.pose(number, place))));
                let held = part(0).filter(|_| self.always_held).into_iter().collect();
                Goal::Partial(PartialGoal { poses: poses.collect(), held, ..PartialGoal::default() })
            }
            Asks::LastSupport => {
                let last = robot.surface(&format!("table{}/top", self.tables.len() - 1));
                let lying = part(0).map(|part| (part, last.into_iter().collect()));
                let (lying, hands) = (lying.into_iter().collect(), hands.into_iter().collect());
                Goal::Partial(PartialGoal { lying, hands, ..PartialGoal::default() })
            }
        }
    }
}

/// The arm with two jaws, which slide along y of its last link and are [`OPENING`] apart when they are open.
fn arm_with_jaws() -> Model {
    let mut model = seven_axis_arm();
    let last = model.links.len() - 1;
    for (name, side) in [("left", 1.0), ("right", -1.0)] {
        let shape = Geometry::Box { half_extents: DVec3::new(0.01, 0.005, 0.03) };
        let shapes = vec![(Pose::from_translation(DVec3::Y * 0.005 * side), shape)];
        model.links.push(LinkModel { name: format!("{name}_jaw"), shapes, inertial: None });
        model.joints.push(JointModel {
            name: name.into(),
            kind: JointKind::Prismatic,
            parent: last,
            child: model.links.len() - 1,
            parent_from_joint: Pose::from_translation(DVec3::Z * 0.125),
            axis: DVec3::Y,
            limits: if side > 0.0 { (0.0, 0.5 * OPENING) } else { (-0.5 * OPENING, 0.0) },
            velocity_limit: None,
            mimic: (side < 0.0).then(|| ("left".into(), -1.0, 0.0)),
        });
    }
    model
}
