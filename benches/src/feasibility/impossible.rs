//! Problems without a solution, each by one cause.

use crate::feasibility::scene::{Asks, Hand, OPENING, Place, Scene};
use crate::feasibility::solvable::{free_place, turned};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// How far start and goal are from each other, metres.
const APART: f64 = 0.4;

/// What makes a problem impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The box starts beyond the arm.
    StartTooFar,
    /// The box shall stand beyond the arm.
    GoalTooFar,
    /// The box shall lie on a table beyond the arm.
    SurfaceTooFar,
    /// The box is wider than the jaws open.
    TooWide,
    /// Walls stand so close to the box that no hand fits between.
    TooTight,
    /// The box starts under a cover.
    WalledIn,
    /// The box shall stand under a cover.
    GoalWalledIn,
    /// The arm has no gripper.
    NoGripper,
    /// The box has no handle.
    NoHandle,
    /// The hand has to hold one box all the time, and another one shall be moved.
    HeldForEver,
    /// Two boxes shall stand in each other.
    GoalsOverlap,
    /// Where the box starts it can be held from the side alone, where it shall stand from above alone, and there is nowhere else.
    NoCommonGrasp,
}

impl Cause {
    /// All causes.
    pub const ALL: [Self; 12] = [
        Self::StartTooFar,
        Self::GoalTooFar,
        Self::SurfaceTooFar,
        Self::TooWide,
        Self::TooTight,
        Self::WalledIn,
        Self::GoalWalledIn,
        Self::NoGripper,
        Self::NoHandle,
        Self::HeldForEver,
        Self::GoalsOverlap,
        Self::NoCommonGrasp,
    ];

    /// The cause in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::StartTooFar => "start out of reach",
            Self::GoalTooFar => "goal out of reach",
            Self::SurfaceTooFar => "surface too far",
            Self::TooWide => "wider than the hand opens",
            Self::TooTight => "no room for the hand",
            Self::WalledIn => "walled in at the start",
            Self::GoalWalledIn => "walled in at the goal",
            Self::NoGripper => "no gripper",
            Self::NoHandle => "no handle",
            Self::HeldForEver => "hand never free",
            Self::GoalsOverlap => "goals overlap",
            Self::NoCommonGrasp => "no common grasp",
        }
    }
}

/// A problem with that cause; the same for the same seed.
#[must_use]
pub fn scene(cause: Cause, seed: u64) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let size = DVec3::new(0.06, 0.06, rng.random_range(0.05..0.08));
    let start = free_place(&mut rng);
    // What stands around one of them leaves the other alone.
    let goal = loop {
        let goal = free_place(&mut rng);
        if (goal.x - start.x).hypot(goal.y - start.y) > APART {
            break goal;
        }
    };
    // Farther than the arm gets with its hand upright, some also farther than it gets at all.
    let (distance, angle) = (rng.random_range(1.2..1.7), rng.random_range(-0.9_f64..0.9));
    let far = Place { x: distance * angle.cos(), y: distance * angle.sin(), turn: rng.random_range(0.0..TAU) };
    let plain = |start, goal| Scene::new(vec![size], vec![start], vec![goal]);
    match cause {
        Cause::StartTooFar => plain(far, goal),
        Cause::GoalTooFar => plain(start, far),
        Cause::SurfaceTooFar => {
            let mut scene = Scene { asks: Asks::LastSupport, ..plain(start, goal) };
            let height = rng.random_range(0.05..0.3);
            scene.tables.push((DVec3::new(0.3, 0.3, 0.02), DVec3::new(1.15 * far.x, 1.15 * far.y, height)));
            scene
        }
        Cause::TooWide => {
            let width = OPENING + rng.random_range(0.005..0.05);
            let boxes = vec![DVec3::new(rng.random_range(0.04..0.08), width, size.z)];
            Scene { hand: Hand::Jaws, boxes, ..plain(start, goal) }
        }
        Cause::TooTight => {
            let (room, height) = (rng.random_range(0.003..0.012), rng.random_range(0.2..0.35));
            let start = Place { turn: 0.0, ..start };
            Scene { walls: around(start, 0.03 + room, height), ..plain(start, goal) }
        }
        Cause::WalledIn | Cause::GoalWalledIn => {
            let room = rng.random_range(0.06..0.1);
            let place = if cause == Cause::WalledIn { start } else { goal };
            let mut walls = around(place, room, 0.14);
            walls.push(roof(place, room, 0.14));
            Scene { walls, ..plain(start, goal) }
        }
        Cause::NoGripper => Scene { hand: Hand::None, ..plain(start, goal) },
        Cause::NoHandle => Scene { handles: Vec::new(), ..plain(start, goal) },
        Cause::HeldForEver => held_for_ever(size, start, &mut rng),
        Cause::GoalsOverlap => {
            let other = Place { x: goal.x + rng.random_range(0.0..0.03), y: goal.y + 0.01, turn: goal.turn };
            let apart = Place { x: 0.62, y: -start.y.signum() * 0.45, turn: 0.0 };
            let asks = if rng.random() { Asks::Poses } else { Asks::Configuration };
            Scene { asks, ..Scene::new(vec![size; 2], vec![start, apart], vec![goal, other]) }
        }
        Cause::NoCommonGrasp => no_common_grasp(size, &mut rng),
    }
}

/// The hand is empty in no state, and holds the first box at the start and in the goal: it never takes the second.
fn held_for_ever(size: DVec3, start: Place, rng: &mut ChaCha8Rng) -> Scene {
    let other = Place { x: 0.62, y: -start.y.signum() * 0.4, turn: 0.0 };
    let goal = turned(Place { x: 0.5, ..other }, rng);
    Scene { always_held: true, ..Scene::new(vec![size; 2], vec![start, other], vec![start, goal]) }
}

/// Two pads: on the first one the box stands under a roof, on the second one between walls.
fn no_common_grasp(size: DVec3, rng: &mut ChaCha8Rng) -> Scene {
    let side = if rng.random() { 1.0 } else { -1.0 };
    let start = Place { x: rng.random_range(0.68..0.74), y: 0.25 * side, turn: 0.0 };
    let goal = Place { x: rng.random_range(0.55..0.65), y: -0.25 * side, turn: 0.0 };
    let height = 0.2;
    let pad = |place: Place| (DVec3::new(0.03, 0.03, 0.02), DVec3::new(place.x, place.y, height));
    let lifted = |(size, middle): (DVec3, DVec3)| (size, middle + DVec3::Z * height);
    let mut walls: Vec<_> = around(goal, 0.09, 0.2).into_iter().map(lifted).collect();
    walls.push(lifted(roof(start, 0.08, 0.18)));
    let tables = vec![pad(start), pad(goal)];
    Scene { walls, tables, handles: vec!["top", "side"], ..Scene::new(vec![size], vec![start], vec![goal]) }
}

/// Four walls around a place, along the axes of the world: how far their inner faces are from its middle, and how high they are, metres.
pub(crate) fn around(place: Place, room: f64, height: f64) -> Vec<(DVec3, DVec3)> {
    let (thick, out) = (0.02, room + 0.011);
    let long = 2.0 * room + 0.06;
    let at = |x: f64, y: f64| DVec3::new(place.x + x, place.y + y, 0.5 * height + 1e-3);
    vec![
        (DVec3::new(thick, long, height), at(out, 0.0)),
        (DVec3::new(thick, long, height), at(-out, 0.0)),
        (DVec3::new(long, thick, height), at(0.0, out)),
        (DVec3::new(long, thick, height), at(0.0, -out)),
    ]
}

/// A roof over a place, on walls of that height.
fn roof(place: Place, room: f64, height: f64) -> (DVec3, DVec3) {
    let wide = 2.0 * room + 0.06;
    (DVec3::new(wide, wide, 0.02), DVec3::new(place.x, place.y, height + 0.012))
}
