//! Problems with a solution: boxes stand where the arm holds them from above, with room for the hand.

use crate::feasibility::impossible;
use crate::feasibility::scene::{Asks, Hand, Place, Scene};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// How near and how far places are from the arm, metres, and how far aside, radians.
const NEAR: f64 = 0.5;
const FAR: f64 = 0.78;
const ASIDE: f64 = 1.0;
/// Middles of boxes are so far apart, metres.
const APART: f64 = 0.14;

/// What a problem has in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// One box, goal as poses or as a whole configuration.
    OneBox,
    /// Two boxes that change places.
    Swap,
    /// Three boxes, each to another place.
    ThreeBoxes,
    /// A box between the jaws of a hand, nearly as wide as they open.
    Jaws,
    /// Low walls around start and goal.
    LowWalls,
    /// A wall between start and goal.
    Between,
    /// A second table on which the box shall lie, wherever.
    Table,
    /// A box on a small table that can be held from above and from the side.
    TwoHandles,
    /// As impossible problems without a common grasp, with a table on which the grasp can be changed.
    ChangeOfGrasp,
}

impl Task {
    /// All tasks.
    pub const ALL: [Self; 9] = [
        Self::OneBox,
        Self::Swap,
        Self::ThreeBoxes,
        Self::Jaws,
        Self::LowWalls,
        Self::Between,
        Self::Table,
        Self::TwoHandles,
        Self::ChangeOfGrasp,
    ];

    /// The task in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::OneBox => "one box",
            Self::Swap => "swap",
            Self::ThreeBoxes => "three boxes",
            Self::Jaws => "jaws",
            Self::LowWalls => "low walls",
            Self::Between => "wall between",
            Self::Table => "onto a table",
            Self::TwoHandles => "two handles",
            Self::ChangeOfGrasp => "change of grasp",
        }
    }
}

/// A problem of that task; the same for the same seed.
#[must_use]
pub fn scene(task: Task, seed: u64) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let size = DVec3::new(0.06, rng.random_range(0.03..0.07), rng.random_range(0.05..0.08));
    let asks = if rng.random() { Asks::Poses } else { Asks::Configuration };
    let places = apart(6, &mut rng);
    let plain = Scene { asks, ..Scene::new(vec![size], vec![places[0]], vec![places[1]]) };
    match task {
        Task::OneBox => plain,
        Task::Swap => {
            let goals = vec![turned(places[1], &mut rng), turned(places[0], &mut rng)];
            Scene { asks, ..Scene::new(vec![size; 2], places[..2].to_vec(), goals) }
        }
        Task::ThreeBoxes => Scene { asks, ..Scene::new(vec![size; 3], places[..3].to_vec(), places[3..].to_vec()) },
        Task::Jaws => Scene { hand: Hand::Jaws, ..plain },
        Task::LowWalls => {
            let mut scene = plain;
            let low = rng.random_range(0.01..0.03);
            // Walls around one place leave the other alone.
            let far = |place: &&Place| (place.x - places[0].x).hypot(place.y - places[0].y) > 0.25;
            let opposite = Place { y: -places[0].y.signum() * 0.3, ..places[0] };
            scene.goals = vec![places.iter().find(far).copied().unwrap_or(opposite)];
            let places = [scene.starts[0], scene.goals[0]];
            scene.walls = places.into_iter().flat_map(|place| impossible::around(place, 0.055, low)).collect();
            scene
        }
        Task::Between => {
            let mut scene = plain;
            let (start, goal) = (scene.starts[0], scene.goals[0]);
            let middle = DVec3::new(0.5 * (start.x + goal.x), 0.5 * (start.y + goal.y), 0.05);
            scene.walls.push((DVec3::new(0.015, 0.015, 0.1), middle));
            scene
        }
        Task::Table => {
            let mut scene = Scene { asks: Asks::LastSupport, ..plain };
            let Place { x, y, .. } = scene.goals[0];
            scene.tables[0] = (DVec3::new(0.04, 0.04, 0.02), DVec3::new(scene.starts[0].x, scene.starts[0].y, 0.0));
            scene.tables.push((DVec3::new(0.1, 0.1, 0.02), DVec3::new(x, y, rng.random_range(0.0..0.12))));
            scene
        }
        Task::TwoHandles => Scene { handles: vec!["top", "side"], ..plain },
        Task::ChangeOfGrasp => {
            let mut scene = impossible::scene(impossible::Cause::NoCommonGrasp, seed);
            scene.tables.push((DVec3::new(0.2, 0.2, 0.02), DVec3::new(0.68, 0.0, 0.2)));
            scene
        }
    }
}

/// A place in front of the arm.
pub(crate) fn free_place(rng: &mut ChaCha8Rng) -> Place {
    let (distance, angle) = (rng.random_range(NEAR..FAR), rng.random_range(-ASIDE..ASIDE));
    Place { x: distance * angle.cos(), y: distance * angle.sin(), turn: rng.random_range(0.0..TAU) }
}

/// The place, turned anyhow.
pub(crate) fn turned(place: Place, rng: &mut ChaCha8Rng) -> Place {
    Place { turn: rng.random_range(0.0..TAU), ..place }
}

/// Places in front of the arm that do not touch each other.
fn apart(count: usize, rng: &mut ChaCha8Rng) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    while places.len() < count {
        let place = free_place(rng);
        if places.iter().all(|other| (place.x - other.x).hypot(place.y - other.y) > APART) {
            places.push(place);
        }
    }
    places
}
