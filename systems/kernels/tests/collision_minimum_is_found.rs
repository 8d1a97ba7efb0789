//! The least clearance along a motion: a bound below it over the continuum, close to what is reached, and where.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod collision_models;

use collision_models::{at, bench, compose, cuboid, joint, link, place, placed, random_configuration, single};
use foliate_components::Pose;
use foliate_components::problem::Margin;
use foliate_components::robot::model::{JointKind, Model};
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_kernels::collision::{
    CollisionScene, CollisionScratch, DistanceQuery, MinimumClearance, MinimumSettings, PairId, PairRule, PairSet,
    minimum_clearance_along, pair_clearance,
};
use foliate_kernels::kinematics::{Kinematics, RigidAttachment};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

struct Motion {
    robot: Robot,
    scene: CollisionScene,
    kinematics: Kinematics,
    rigid_attachments: Vec<RigidAttachment>,
    pairs: PairSet,
}

impl Motion {
    fn new(robot: Robot, rule: &PairRule<'_>, rigid_attachments: Vec<RigidAttachment>) -> Self {
        let scene = CollisionScene::new(&robot, rule);
        let pairs = PairSet::new(&scene, &rigid_attachments, &[]);
        Self { kinematics: Kinematics::new(&robot), robot, scene, rigid_attachments, pairs }
    }

    fn least(&self, knots: &[f64], settings: &MinimumSettings) -> MinimumClearance {
        let mut scratch = CollisionScratch::new();
        let Self { scene, kinematics, rigid_attachments, pairs, .. } = self;
        let found = minimum_clearance_along(scene, kinematics, rigid_attachments, knots, pairs, settings, &mut scratch);
        // Buffers that have seen another motion change nothing.
        let again = minimum_clearance_along(scene, kinematics, rigid_attachments, knots, pairs, settings, &mut scratch);
        assert_eq!(found, again);
        found
    }

    /// A configuration in which nothing touches.
    fn free_start(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        loop {
            let mut q = random_configuration(&self.robot, rng);
            for part in ["box1", "box2"] {
                place(&self.robot, &mut q, part, Pose::IDENTITY);
            }
            if self.at(&q, 0.0, None) > 0.0 {
                return q;
            }
        }
    }

    /// The least distance less margin of all pairs at a place of the polyline, to within a micrometre.
    fn at(&self, knots: &[f64], t: f64, only: Option<PairId>) -> f64 {
        let size = self.robot.space.size();
        let piece = (t as usize).min((knots.len() / size).saturating_sub(2));
        let mut q = knots[piece * size..][..size].to_vec();
        if knots.len() > size {
            let (a, b) = knots[piece * size..][..2 * size].split_at(size);
            self.robot.space.interpolate(a, b, t - piece as f64, &mut q);
        }
        let mut X_WJ = vec![Pose::IDENTITY; self.kinematics.bodies()];
        self.kinematics.forward(&q, &mut X_WJ);
        self.kinematics.carry(&q, &self.rigid_attachments, &mut X_WJ);
        let all = (0..self.scene.pairs().len() as u32).map(PairId).filter(|&id| only.is_none_or(|o| o == id));
        let clearance = |id: PairId| {
            let ask = DistanceQuery::exact(f64::MAX);
            pair_clearance(&self.scene, id, &X_WJ, ask, &mut DVec3::ZERO.clone()) - self.pairs.margin(id)
        };
        all.map(clearance).fold(f64::INFINITY, f64::min)
    }

    /// Compares with distances at many places.
    fn holds(&self, knots: &[f64], settings: &MinimumSettings) -> MinimumClearance {
        let found = self.least(knots, settings);
        let pieces = (knots.len() / self.robot.space.size() - 1).max(1);
        let places = (0..=400).map(|i| f64::from(i) / 400.0 * pieces as f64);
        let sampled = places.map(|t| self.at(knots, t, None)).fold(f64::INFINITY, f64::min);
        assert!(found.lower <= sampled + 1e-9, "{found:?}, sampled {sampled}");
        let nearest = found.nearest.unwrap();
        let there = self.at(knots, nearest.t, Some(nearest.pair));
        assert!(there <= nearest.clearance + 1e-9, "{there} at {nearest:?}");
        let allowed = settings.absolute.max(settings.relative * nearest.clearance.abs());
        assert!(nearest.clearance - found.lower <= allowed + 1e-12, "{found:?}");
        // Nothing between the samples is farther below them than they are apart.
        assert!(nearest.clearance <= sampled + allowed + 1e-5, "{found:?}, sampled {sampled}");
        found
    }
}

#[test]
fn of_random_motions_of_two_arms() {
    let robot = bench();
    let root = |part: &str| robot.parts[robot.part(part).unwrap().at()].root_joint.unwrap();
    let rigid_attachments = vec![
        RigidAttachment { object: root("box1"), carrier: robot.joint("robot/left_j6"), X_CO: at(0.23, 0.0, 0.0) },
        RigidAttachment { object: root("box2"), carrier: None, X_CO: at(0.8, -0.3, -0.114) },
    ];
    let ignored = collision_models::always_colliding(&robot);
    let motion = Motion::new(robot, &PairRule { ignored: &ignored, ..PairRule::default() }, rigid_attachments);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut free = 0;
    for round in 0..100 {
        let mut knots = Vec::new();
        let mut start = motion.free_start(&mut rng);
        knots.extend_from_slice(&start);
        for _ in 0..1 + round % 4 {
            let delta: Vec<f64> = (0..motion.robot.space.dimension()).map(|_| rng.random_range(-0.04..0.04)).collect();
            let mut next = start.clone();
            motion.robot.space.integrate(&start, &delta, &mut next);
            for part in ["box1", "box2"] {
                place(&motion.robot, &mut next, part, Pose::IDENTITY);
            }
            knots.extend_from_slice(&next);
            start = next;
        }
        let settings = [MinimumSettings::default(), MinimumSettings { relative: 0.01, ..MinimumSettings::default() }];
        let found = motion.least(&knots, &settings[0]);
        if found.lower == f64::NEG_INFINITY {
            let nearest = found.nearest.unwrap();
            assert!(motion.at(&knots, nearest.t, Some(nearest.pair)) <= 1e-6, "{nearest:?} does not touch");
            continue;
        }
        free += 1;
        for settings in &settings {
            motion.holds(&knots, settings);
        }
    }
    assert!(free > 10, "only {free} motions are free");
}

/// A carriage on a rail with a plate beside it at the given distance, and a locked slide with a block on it.
fn rigid_attachment(plate: f64, block: f64) -> Model {
    let rail = |name: &str, kind, child, pose| joint(name, kind, 0, child, pose, DVec3::X);
    Model {
        name: "cell".into(),
        links: vec![
            link("floor", Vec::new()),
            link("carriage", vec![(Pose::IDENTITY, cuboid(0.2, 0.2, 0.2))]),
            link("plate", vec![(at(0.0, 0.1 + plate + 0.01, 0.0), cuboid(0.05, 0.02, 0.2))]),
            link("block", vec![(at(0.0, 0.1 + plate + 0.02 + block + 0.05, 0.0), cuboid(0.1, 0.1, 0.1))]),
        ],
        joints: vec![
            rail("rail", JointKind::Prismatic, 1, Pose::IDENTITY),
            rail("mount", JointKind::Fixed, 2, Pose::IDENTITY),
            rail("slide", JointKind::Prismatic, 3, Pose::IDENTITY),
        ],
        has_srdf: true,
        ..Model::default()
    }
}

#[test]
fn where_a_carriage_passes_a_plate_and_what_does_not_move() {
    for (plate, block) in [(0.013, 0.5), (0.5, 0.004), (0.02, 0.019)] {
        let model = rigid_attachment(plate, block);
        let robot = compose(&[(&model, placed("p", PartKind::Robot, RootJoint::Fixed, Pose::IDENTITY))]);
        let locked = [robot.joint("p/slide").unwrap()];
        let motion = Motion::new(robot, &PairRule { locked: &locked, ..PairRule::default() }, Vec::new());
        let found = motion.holds(&[-0.9, 0.0, 0.7, 0.0], &MinimumSettings::default());
        let least = plate.min(block);
        assert!(found.lower <= least && found.lower >= 0.9 * least - 1e-5, "{found:?} {least}");
        if plate < block {
            // The plate is passed from x = −0.125 to 0.125.
            let nearest = found.nearest.unwrap();
            assert!((-0.125 - 1e-2..=0.125 + 1e-2).contains(&(-0.9 + 1.6 * nearest.t)), "{nearest:?}");
        }
    }
}

#[test]
fn margins_are_taken_off_and_what_is_farther_is_of_no_interest() {
    let (cube, board) =
        (single(vec![(Pose::IDENTITY, cuboid(0.1, 0.1, 0.1))]), single(vec![(Pose::IDENTITY, cuboid(2.0, 2.0, 0.05))]));
    let robot = compose(&[
        (&cube, placed("box", PartKind::Object, RootJoint::FreeFlyer, Pose::IDENTITY)),
        (&board, placed("board", PartKind::Environment, RootJoint::Fixed, at(0.0, 0.0, -0.025))),
    ]);
    let (first, second) = (robot.link("board/body").unwrap(), robot.link("box/body").unwrap());
    let margins = [Margin { first, second, distance: 0.02 }];
    let motion = Motion::new(robot, &PairRule { margins: &margins, ..PairRule::default() }, Vec::new());
    let height = |z: f64| {
        let mut q = motion.robot.space.neutral();
        place(&motion.robot, &mut q, "box", at(0.0, 0.0, 0.05 + z));
        q
    };
    let knots = [height(0.3), height(0.05), height(0.4)].concat();
    let found = motion.holds(&knots, &MinimumSettings::default());
    assert!(found.lower <= 0.03 && found.lower >= 0.0265, "{found:?}");
    assert!((found.nearest.unwrap().t - 1.0).abs() < 0.05, "{found:?}");
    let far = motion.least(&knots, &MinimumSettings { below: 0.01, ..MinimumSettings::default() });
    assert!(far.nearest.is_none() && far.lower >= 0.009 && far.lower <= 0.03, "{far:?}");
    let poor = motion.least(&knots, &MinimumSettings { max_queries: 1, ..MinimumSettings::default() });
    assert!(poor.is_cut_short && poor.lower <= 0.03, "{poor:?}");
    // One configuration is a motion too.
    let still = motion.least(&height(0.1), &MinimumSettings::default());
    assert!(still.lower <= 0.08 && still.lower >= 0.07, "{still:?}");
    let through = motion.least(&[height(0.2), height(-0.3)].concat(), &MinimumSettings::default());
    assert_eq!(through.lower, f64::NEG_INFINITY);
}
