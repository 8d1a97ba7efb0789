//! Where the straight motion between two configurations of a leaf is blocked, it is planned as a problem of its own: trees grow from
//! both ends, are turned aside at what is in the way, and what comes of it is certified like every other motion.

#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded, stop_within};
use foliate_components::Pose;
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::outcome::SearchOutcome;
use foliate_components::problem::{Goal, Problem};
use foliate_components::robot::{PartIndex, Robot};
use foliate_components::samples::models::{block, environment, fixed_robot, two_joint_arm};
use foliate_kernels::collision::{CollisionScratch, adjacent_links};
use foliate_schedulers::mrrt::Mrrt;
use foliate_schedulers::sequence::Sequence;
use foliate_systems::events::EventSink;
use foliate_systems::exploration::roots::Roots;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::search::Search;
use foliate_systems::step::local_planner::leaf_space::{LeafScratch, LeafSpace};
use foliate_systems::step::local_planner::rrt_connect::LocalPlan;
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const START: [f64; 2] = [-1.2, 0.0];
const GOAL: [f64; 2] = [1.2, 0.0];

/// Two links of a metre, stretched out, and a post between start and goal that they pass only when bent.
fn past_a_post() -> PlanningModel {
    with_posts_at(1.6)
}

/// The same with posts at a distance from the shoulder, before it and behind it.
fn with_posts_at(far: f64) -> PlanningModel {
    let (arm, post) = (two_joint_arm(), block(DVec3::new(0.1, 0.1, 1.0)));
    let at = |x| Pose::from_translation(DVec3::X * x);
    let parts = [
        (&arm, fixed_robot("arm", Pose::identity())),
        (&post, environment("post", at(far))),
        (&post, environment("back", at(-far))),
    ];
    let robot = Robot::compose(&parts).unwrap();
    let ignored_pairs =
        (0..robot.parts.len() as u32).flat_map(|part| adjacent_links(&robot, PartIndex(part))).collect();
    let goals = vec![Goal::Configuration(GOAL.to_vec())];
    model(Problem { ignored_pairs, ..Problem::new("past a post", robot, START.to_vec(), goals) })
}

/// Whether a polyline of configurations is free wherever it is looked at.
fn is_free(model: &PlanningModel, knots: &[f64]) -> bool {
    let (space, mut scratch, mut q) = (&model.problem.robot.space, CollisionScratch::default(), vec![0.0; 2]);
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    let knots: Vec<&[f64]> = knots.chunks_exact(2).collect();
    knots.windows(2).all(|ends| {
        (0..=100).all(|k| {
            space.interpolate(ends[0], ends[1], f64::from(k) / 100.0, &mut q);
            model.kinematics.forward(&q, &mut X_WJ);
            model.first_collision(StateId(0), &X_WJ, 0.0, &mut scratch).is_none()
        })
    })
}

#[test]
fn the_answer_is_free_and_the_same_on_any_number_of_threads() {
    let model = past_a_post();
    for seed in 1..=5 {
        let runs = [1, 2, 5].map(|threads| search(&model, &Sequence, seeded(seed), threads));
        let paths = runs.map(|(outcome, search)| {
            assert_eq!(outcome, SearchOutcome::Solved);
            search.path().unwrap()
        });
        assert!(paths.iter().all(|path| path.segments == paths[0].segments));
        let knots: Vec<&Vec<f64>> = paths[0].segments.iter().flat_map(|segment| &segment.knots).collect();
        assert_eq!((&knots[0][..], &knots[knots.len() - 1][..]), (&START[..], &GOAL[..]));
        assert!(is_free(&model, &knots.into_iter().flatten().copied().collect::<Vec<_>>()), "seed {seed}");
    }
}

#[test]
fn what_cannot_be_planned_ends_when_its_memory_is_spent() {
    // However it is bent, the arm is as long as the posts are far.
    let model = with_posts_at(1.15);
    let bounded = |threads| {
        let settings = seeded(1).with(|settings| settings.max_bytes = 400_000);
        let (outcome, mut search) = search(&model, &Sequence, settings, threads);
        assert_eq!(outcome, SearchOutcome::MemoryLimit);
        let tried: u64 = search.statistics().iter().map(|(_, statistics)| statistics.attempts).sum();
        assert!(tried > 100, "{tried}");
        (search.counter(), tried)
    };
    assert_eq!(bounded(1), bounded(2));
}

#[test]
fn plans_are_certified_motions_between_the_nodes() {
    let model = past_a_post();
    let settings = seeded(1);
    let search = Search::new(&model, &Mrrt, settings.clone(), stop_within(60), EventSink::default());
    let (leaves, roots) = (search.world().resource::<LeafIndex>(), search.world().resource::<Roots>());
    let (start, goal) = (roots.start.unwrap(), roots.goals[0]);
    let leaf = LeafSpace::new(&model, &settings, leaves, search.roadmap().node(start).leaf).unwrap();
    let mut scratch = LeafScratch::default();
    assert!(!leaf.extend(&START, &GOAL, &mut scratch).is_some_and(|motion| motion.arrives), "nothing to plan");

    for seed in 1..=20 {
        let mut plan = LocalPlan::between([(start, &START), (goal, &GOAL)]);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let planned = plan.grow(&leaf, (&START, &GOAL), 2000, &mut rng, &mut scratch).unwrap();
        assert_eq!((planned.from, planned.to), (start, goal));
        let knots = &planned.motion.knots;
        assert_eq!((&knots[..2], &knots[knots.len() - 2..]), (&START[..], &GOAL[..]));
        assert!(is_free(&model, knots), "seed {seed}");
        assert!(planned.motion.clearance > 0.0 && plan.work <= 2000, "{planned:?}");
    }
}

#[test]
fn blocked_motions_turn_aside_from_what_is_in_the_way() {
    let model = past_a_post();
    let settings = seeded(1);
    let search = Search::new(&model, &Mrrt, settings.clone(), stop_within(60), EventSink::default());
    let leaves = search.world().resource::<LeafIndex>();
    let start = search.world().resource::<Roots>().start.unwrap();
    let leaf = LeafSpace::new(&model, &settings, leaves, search.roadmap().node(start).leaf).unwrap();
    let mut scratch = LeafScratch::default();
    // The lower link meets the post from the side of the start.
    let blocked = leaf.extend(&[-0.4, -0.4], &[0.6, 0.4], &mut scratch).unwrap();
    let (end, pair) = (blocked.end(2).to_vec(), blocked.blocked_by.unwrap());
    let aside = leaf.retract(&end, &[0.6, 0.4], pair, &mut scratch).unwrap();
    let further = leaf.extend(&end, &aside, &mut scratch).unwrap();
    assert!(leaf.distance(&end, further.end(2)) > 0.02, "{end:?} {aside:?} {further:?}");
    // A motion away from it is not turned.
    assert!(leaf.retract(&end, &[-1.2, -0.4], pair, &mut scratch).is_none());
}
