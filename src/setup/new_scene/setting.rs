//! Where robot, table and objects stand, found by reach and proved by a plan.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::planner::Planner;
use crate::scene::assemble::parts::shape;
use crate::scene::{PackagePath, Scene};
use crate::setup::collision_matrix::{CollisionMatrix, MatrixPair, PairReason};
use crate::setup::error::SetupError;
use crate::setup::grippers::{FoundGripper, coordinate};
use crate::setup::new_scene::holding::Ways;
use crate::setup::new_scene::own_roots;
use crate::setup::new_scene::read_objects::Object;
use crate::setup::new_scene::request::{DRIVES, NewScene};
use crate::setup::places::arm::Arm;
use crate::setup::places::layout::Maker;
use crate::setup::places::reach::{Reached, reached};
use crate::setup::places::table::{Standing, TableSize, standings, table_pose, table_solid};
use crate::setup::places::taking::{Item, Taker};
use crate::setup::places::world::World;
use crate::setup::solids::surface_points::PURPOSE;
use foliate_components::Pose;
use foliate_components::robot::model::Model;
use foliate_components::robot::{DisabledPair, JointIndex, PartKind, PartPlacement, Robot, RootJoint};
use foliate_systems::runtime::random::stream;
use foliate_systems::settings::SearchSettings;
use glam::DVec3;
use std::cell::RefCell;

/// How far a resting configuration stays off table and objects, metres.
const CLEARANCE: f64 = 0.01;
/// Random configurations in which a free one is looked for.
const TRIES: u32 = 2000;
/// After so many of them all joints are drawn anew.
const ANEW: u32 = 100;
/// Layouts that are planned for, until one is solved.
const LAYOUTS: usize = 6;
/// Steps of each such search.
const STEPS: u64 = 1500;
/// Of the layouts of a table, best first, those that are planned for.
const SKIPPED: [usize; 3] = [0, 3, 9];

/// Layouts so far.
struct Tried {
    /// The text of the first one.
    first: Option<String>,
    /// Why others could not be made.
    refused: Vec<String>,
    /// How many more are planned for.
    left: usize,
}

/// Everything that was found, for the layout.
pub(super) struct Setting<'a> {
    pub request: &'a NewScene,
    pub packages: &'a PackagePath,
    pub model: &'a Model,
    pub robot: &'a Robot,
    /// Of planar and floating joints of the model.
    pub joint_bounds: &'a [(String, f64, f64)],
    pub matrix: &'a CollisionMatrix,
    pub grippers: &'a [FoundGripper],
}

impl Setting<'_> {
    /// The text of the first layout that is solved, and the steps that took; or of the first layout.
    pub fn written(&self, objects: &[Object], ways: &Ways) -> Result<(String, Option<u64>), SetupError> {
        let size = TableSize { sides: self.request.table.sides, height: self.request.table.height };
        let arms = self.arms(self.robot);
        let alone = World::new(self.robot.clone(), &self.ignored(self.robot));
        let reach = self.reached(&alone, &arms, &self.opened(&alone));
        let mut tried = Tried { first: None, refused: Vec::new(), left: LAYOUTS };
        let standings = match self.request.table.place {
            Some(place) => vec![Standing::at(place, size.height)],
            None => standings(self.robot, &arms, &reach, &size),
        };
        for standing in standings {
            // What drives stands on the floor.
            if self.drives() && standing.robot_height > 0.0 {
                continue;
            }
            if let Some(found) = self.beside(&standing, &size, (objects, ways), &mut tried)? {
                return Ok(found);
            }
            if tried.left == 0 {
                break;
            }
        }
        match tried.first {
            Some(text) => Ok((text, None)),
            None => {
                let why = tried.refused.into_iter().next().unwrap_or_else(|| {
                    format!("no gripper gets above a table {} m high beside the robot", size.height)
                });
                Err(SetupError::OutOfReach(match self.drives() {
                    // A robot on the floor comes to a height with the postures that its joints allow there.
                    true => format!(
                        "{why} (the table is {} m high; --table \"LENGTH WIDTH HEIGHT\" sets that)",
                        size.height
                    ),
                    false => why,
                }))
            }
        }
    }

    /// Layouts on a table that stands so; the first one that is solved.
    fn beside(
        &self,
        standing: &Standing,
        size: &TableSize,
        (objects, ways): (&[Object], &Ways),
        tried: &mut Tried,
    ) -> Result<Option<(String, Option<u64>)>, SetupError> {
        let world = self.world(objects, standing, size)?;
        let Some(q) = self.resting(&world) else {
            tried.refused.push("the robot is in collision in every configuration that was tried".to_owned());
            return Ok(None);
        };
        let arms = self.arms(&world.robot);
        let reached = self.reached(&world, &arms, &q);
        let maker = Maker {
            taker: Taker {
                world: &world,
                arms: &arms,
                grippers: self.grippers,
                reached: &reached,
                stops: RefCell::default(),
            },
            X_WT: standing.X_WT,
            size: *size,
            q: q.clone(),
        };
        let items = objects.iter().enumerate();
        let items: Vec<Item<'_>> = items
            .map(|(at, o)| Item { object: &o.rigid, faces: &o.faces, handles: &o.handles, part: at + 2 })
            .collect();
        for skip in SKIPPED {
            let layout = match maker.layout(&items, skip) {
                Ok(layout) => layout,
                Err(why) => {
                    tried.refused.push(why);
                    break;
                }
            };
            let text = self.draft(objects, ways, (standing, size), &layout, &q)?.text();
            if let Some(steps) = self.solves(&text)? {
                return Ok(Some((text, Some(steps))));
            }
            tried.first.get_or_insert(text);
            tried.left -= 1;
            if tried.left == 0 {
                break;
            }
        }
        Ok(None)
    }

    /// Plans; the steps of the search where a path was found.
    fn solves(&self, text: &str) -> Result<Option<u64>, SetupError> {
        let folder = crate::scene::sources::mesh_name::folder_of(&self.request.place);
        let scene = Scene::from_text(&self.request.place.display().to_string(), text, folder, self.packages)?;
        let planner = Planner::new(scene).map_err(|error| SetupError::Request(error.to_string()))?;
        let settings = SearchSettings::default().with(|s| (s.seed, s.max_steps) = (self.request.seed, STEPS));
        Ok(planner.settings(settings).first_path().solve().ok().map(|solution| solution.report.steps))
    }

    pub fn arms(&self, robot: &Robot) -> Vec<Arm> {
        let arm = |gripper: &FoundGripper| {
            let link = robot.link(&self.robot.links[gripper.link.at()].name);
            let link = &robot.links[link.map_or(0, |link| link.at())];
            Arm::new(robot, link.joint, link.joint_from_link * gripper.link_from_gripper)
        };
        self.grippers.iter().map(arm).collect()
    }

    fn reached(&self, world: &World, arms: &[Arm], q: &[f64]) -> Vec<Vec<Reached>> {
        arms.iter().enumerate().map(|(at, arm)| reached(world, arm, q, self.request.seed, at)).collect()
    }

    /// The pairs that a layout does not test, in a robot that has these links first: those that a scene leaves out, and those that touched
    /// in no sample. The plan tests the latter.
    fn ignored(&self, robot: &Robot) -> Vec<DisabledPair> {
        let pair = |first: &str, second: &str| {
            let (first, second) = (robot.link(first)?, robot.link(second)?);
            Some(DisabledPair { first, second, reason: "scene".into() })
        };
        let name = |link: foliate_components::robot::LinkIndex| self.robot.links[link.at()].name.as_str();
        let is_left_out = |p: &&MatrixPair| p.reason.is_by_design() || p.reason == PairReason::Never;
        self.matrix.pairs.iter().filter(is_left_out).filter_map(|p| pair(name(p.first), name(p.second))).collect()
    }

    /// Robot, table and objects as one.
    fn world(&self, objects: &[Object], standing: &Standing, size: &TableSize) -> Result<World, SetupError> {
        let height = Pose::from_translation(DVec3::Z * standing.robot_height);
        let table = shape::model("table", &table_solid(size), self.packages)?;
        let X_WT = table_pose(standing);
        let mut robot = PartPlacement::new("robot", PartKind::Robot, self.root(), height);
        robot.joint_bounds = self.joint_bounds.to_vec();
        if robot.root == RootJoint::Planar {
            robot.root_bounds = vec![(-DRIVES, DRIVES); 2];
        }
        let mut parts = vec![
            (self.model, robot),
            (&table, PartPlacement::new("table", PartKind::Environment, RootJoint::Fixed, X_WT)),
        ];
        for object in objects {
            let mut free = PartPlacement::new(&object.name, PartKind::Object, RootJoint::FreeFlyer, Pose::identity());
            free.root_bounds = vec![(-1e4, 1e4); 3];
            parts.push((&object.model, free));
        }
        let robot = Robot::compose(&parts).map_err(|error| SetupError::Request(error.to_string()))?;
        let ignored = self.ignored(&robot);
        Ok(World::new(robot, &ignored))
    }

    /// How many coordinates the robot's root has, before those of its joints.
    pub fn root_size(&self) -> usize {
        if self.root() == RootJoint::Planar { 3 } else { 0 }
    }

    /// The joint of the robot's root: planar where it drives and has no joint of its own for that.
    pub fn root(&self) -> RootJoint {
        match self.request.drives && !own_roots::drives(self.model) {
            true => RootJoint::Planar,
            false => RootJoint::Fixed,
        }
    }

    /// Whether the robot drives.
    pub fn drives(&self) -> bool {
        self.request.drives || own_roots::drives(self.model)
    }

    /// The default configuration with all fingers open.
    fn opened(&self, world: &World) -> Vec<f64> {
        let mut q = world.default_configuration();
        for finger in self.grippers.iter().flat_map(|gripper| &gripper.fingers) {
            let joint = world.robot.joint(&self.robot.joints[finger.joint.at()].name);
            if let Some(at) = joint.and_then(|joint| coordinate(&world.robot, joint)) {
                q[at] = finger.open;
            }
        }
        q
    }

    /// A configuration of the robot that is free of collision beside the table: the default one, that in the middle of all bounds, one that
    /// its SRDF names, or a random one.
    fn resting(&self, world: &World) -> Option<Vec<f64>> {
        let robot = &world.robot;
        let mut X_WJ = world.bodies();
        let open = self.opened(world);
        let is_finger = |at: usize| {
            let fingers = self.grippers.iter().flat_map(|gripper| &gripper.fingers);
            let joints = fingers.filter_map(|f| robot.joint(&self.robot.joints[f.joint.at()].name));
            joints.into_iter().any(|joint| coordinate(robot, joint) == Some(at))
        };
        let is_single = |at: usize| {
            let joints = robot.joints.iter().enumerate().filter(|(_, joint)| joint.motion.configuration_size() == 1);
            joints.into_iter().any(|(index, _)| coordinate(robot, JointIndex(index as u32)) == Some(at))
        };
        // What drives stays at the origin.
        let first = self.root_size();
        let end = first + self.robot.space.size();
        let taken = |q: &[f64]| {
            let mut taken = open.clone();
            (first..end).filter(|at| !is_finger(*at) && is_single(*at)).for_each(|at| taken[at] = q[at]);
            taken
        };
        let mut middle = open.clone();
        for (x, (&low, &high)) in middle.iter_mut().zip(robot.space.lower.iter().zip(&robot.space.upper)).take(end) {
            if low.is_finite() && high.is_finite() {
                *x = (low + high) / 2.0;
            }
        }
        let mut tried = vec![open.clone(), taken(&middle)];
        for state in &self.model.group_states {
            let mut q = open.clone();
            for (joint, value) in &state.values {
                if let Some(at) = robot.joint(&format!("robot/{joint}")).and_then(|joint| coordinate(robot, joint)) {
                    q[at] = *value;
                }
            }
            tried.push(taken(&q));
        }
        let found = tried.into_iter().find(|q| {
            world.kinematics.forward(q, &mut X_WJ);
            world.is_free(&X_WJ, None, CLEARANCE)
        });
        let drawn: Vec<usize> = (first..end).filter(|at| !is_finger(*at) && is_single(*at)).collect();
        found.or_else(|| self.drawn(world, &open, &drawn))
    }

    /// A configuration of these coordinates that is free of collision, found from the open one: of two bodies that meet, what moves them
    /// against each other is drawn at random. What meets nothing stays where the default has it, out of the way.
    fn drawn(&self, world: &World, open: &[f64], free: &[usize]) -> Option<Vec<f64>> {
        let (mut q, mut drawn, mut X_WJ) = (open.to_vec(), open.to_vec(), world.bodies());
        (0..TRIES).find_map(|index| {
            world.kinematics.forward(&q, &mut X_WJ);
            let found = world.meeting(&X_WJ, None, CLEARANCE);
            let Some(found) = found else { return Some(q.clone()) };
            let mut again = world.between(found.bodies);
            again.retain(|at| free.contains(at));
            if again.is_empty() || (index + 1) % ANEW == 0 {
                again = free.to_vec();
            }
            world.robot.space.random(&mut stream(self.request.seed, PURPOSE, 100, index), &mut drawn);
            again.iter().for_each(|&at| q[at] = drawn[at]);
            None
        })
    }
}
