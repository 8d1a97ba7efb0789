//! What a constraint graph may be made of besides grasps and tables: constraints of the problem's own, stances, boxes on
//! boxes, magnets, drawers, doors. Each is searched, and what was promised is measured on the path.

#![allow(non_snake_case, reason = "X_AB notation")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use common::{model, search, seeded};
use foliate_components::Pose;
use foliate_components::outcome::{Rejection, SearchOutcome};
use foliate_components::path::ManipulationPath;
use foliate_components::problem::{JointRest, Margin, Problem};
use foliate_components::robot::{LinkIndex, Source};
use foliate_components::samples::{
    carry_a_box_with_its_lid, hold_a_lid_by_a_magnet, make_a_step, move_one_box, move_one_box_with_a_level_hand,
    open_a_box_and_move_it, open_a_drawer, open_a_drawer_with_a_box_in_it, put_a_lid_on_a_box,
};
use foliate_kernels::collision::CollisionScratch;
use foliate_schedulers::mrrt::Mrrt;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::planning_model::state_classification::residual;

/// Solves a problem with some seeds and returns the paths.
fn solved(problem: Problem) -> (PlanningModel, Vec<ManipulationPath>) {
    let model = model(problem);
    let paths = (1..=3).map(|seed| {
        let (outcome, mut search) = search(&model, &Mrrt, seeded(seed).with(|s| s.max_steps = 2000), 2);
        for (id, s) in search.statistics().iter().filter(|_| outcome != SearchOutcome::Solved) {
            println!("{} {s:?}", model.graph.transition(*id).name);
        }
        assert_eq!(outcome, SearchOutcome::Solved, "seed {seed}");
        search.path().unwrap()
    });
    let paths = paths.collect();
    (model, paths)
}

/// Poses of all bodies at a configuration.
fn bodies(model: &PlanningModel, q: &[f64]) -> Vec<Pose> {
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    model.kinematics.forward(q, &mut X_WJ);
    X_WJ
}

/// Every state along a path holds at its knots and half-way between them; segments share their joint knots bit for bit.
fn assert_stays_in_its_states(model: &PlanningModel, path: &ManipulationPath) {
    let space = &model.problem.robot.space;
    for pair in path.segments.windows(2) {
        assert_eq!(pair[0].knots.last(), pair[1].knots.first(), "a joint knot is not shared");
    }
    for segment in &path.segments {
        let state = model.graph.state(segment.state);
        let mut middle = vec![0.0; space.size()];
        for pair in segment.knots.windows(2) {
            space.interpolate(&pair[0], &pair[1], 0.5, &mut middle);
            for (q, tolerance) in [(&pair[0], 1e-5), (&pair[1], 1e-5), (&middle, path.certificate.path_tolerance)] {
                let X_WJ = bodies(model, q);
                for &constraint in &state.manifold {
                    // Objects follow their carriers; the bound on their jumps is the certificate's.
                    if model.object_of(constraint).is_some() && q == &middle {
                        continue;
                    }
                    let off = residual(model, constraint, q, &X_WJ);
                    let name = &model.graph.constraint(constraint).name;
                    assert!(off <= tolerance, "`{name}` of `{}` is off by {off:.2e}", state.name);
                }
            }
        }
    }
}

fn states(model: &PlanningModel, path: &ManipulationPath) -> Vec<String> {
    let mut names: Vec<String> = path.segments.iter().map(|s| model.graph.state(s.state).name.clone()).collect();
    names.dedup();
    names
}

#[test]
fn a_constraint_everywhere_holds_all_along() {
    let (model, paths) = solved(move_one_box_with_a_level_hand().unwrap());
    let level = model.graph.constraints.iter().filter(|c| c.name == "level").count();
    assert_eq!(level, 1);
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        assert!(path.segments.iter().all(|s| model.graph.state(s.state).manifold.len() == 2));
    }
}

#[test]
fn a_foot_is_lifted_and_set_down_elsewhere() {
    let (model, paths) = solved(make_a_step().unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        // It stands, is lifted once at least, and stands.
        let names = states(&model, path);
        assert!(names.contains(&"lifted".to_string()), "{names:?}");
    }
}

#[test]
fn a_lid_is_put_on_a_box() {
    let (model, paths) = solved(put_a_lid_on_a_box().unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        assert_eq!(states(&model, path).last().unwrap(), "free : lid on box");
    }
}

#[test]
fn a_box_is_carried_with_the_lid_that_lies_on_it() {
    let (model, paths) = solved(carry_a_box_with_its_lid().unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        let names = states(&model, path);
        assert!(names.contains(&"arm/hand grasps box/side : lid on box".to_string()), "{names:?}");
    }
}

#[test]
fn a_magnet_takes_over_what_the_hand_brings() {
    let (model, paths) = solved(hold_a_lid_by_a_magnet().unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        // The last thing that happens happens with the lid on the magnet, and box and lid have moved.
        assert_eq!(states(&model, path).last().unwrap(), "box/magnet grasps lid/under");
    }
}

/// The values of a joint along the segments in which a gripper holds a handle, and along the others.
fn values_of(model: &PlanningModel, path: &ManipulationPath, joint: &str) -> (Vec<f64>, Vec<Vec<f64>>) {
    let robot = &model.problem.robot;
    let Source::Coordinates { q, .. } = robot.joints[robot.joint(joint).unwrap().at()].source else { panic!() };
    let (mut held, mut resting) = (Vec::new(), Vec::new());
    for segment in &path.segments {
        let values = segment.knots.iter().map(|knot| knot[q]);
        if model.graph.state(segment.state).grasps.is_empty() {
            resting.push(values.collect())
        } else {
            held.extend(values)
        }
    }
    (held, resting)
}

#[test]
fn a_drawer_stays_where_it_was_left() {
    let (model, paths) = solved(open_a_drawer(JointRest::Stays, 0.2).unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        let (held, resting) = values_of(&model, path, "cabinet/slide");
        assert!(held.iter().any(|&v| v > 0.1));
        // Bit for bit: it is a value of the leaf.
        assert!(resting.iter().all(|values| values.iter().all(|v| v == &values[0])));
    }
}

#[test]
fn what_lies_in_a_drawer_comes_along() {
    let (model, paths) = solved(open_a_drawer_with_a_box_in_it(0.2).unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        assert!(states(&model, path).contains(&"arm/hand grasps cabinet/knob : box on cabinet/tray".to_string()));
    }
}

#[test]
fn a_drawer_that_must_be_shut_is_open_only_while_it_is_held() {
    // Start with the drawer held open (where a first search has come to), goal: shut, the hand away.
    let problem = open_a_drawer(JointRest::At(0.0), 0.0).unwrap();
    let opened = open_a_drawer(JointRest::Stays, 0.2).unwrap();
    let (stays, paths) = solved(opened);
    let q = paths[0].segments.iter().filter(|s| !stays.graph.state(s.state).grasps.is_empty());
    let held_open = q.flat_map(|s| &s.knots).max_by(|a, b| a[7].total_cmp(&b[7])).unwrap().clone();
    assert!(held_open[7] > 0.1);
    let (model, paths) = solved(Problem { start: held_open, ..problem });
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        let (_, resting) = values_of(&model, path, "cabinet/slide");
        assert!(resting.iter().flatten().all(|&v| v == 0.0));
        assert_eq!(states(&model, path).first().unwrap(), "arm/hand grasps cabinet/knob");
    }
    // Open and not held it is in no state.
    let mut loose = open_a_drawer(JointRest::At(0.0), 0.0).unwrap();
    loose.start[7] = 0.1;
    let outcome = search(&common::model(loose), &Mrrt, seeded(1), 1).0;
    let SearchOutcome::InfeasibleStart(why) = outcome else { panic!("{outcome:?}") };
    let why = why.to_string();
    assert!(why.contains("rest_cabinet/slide"), "{why}");
}

#[test]
fn a_box_is_moved_by_its_side_and_opened_by_its_lid() {
    let (model, paths) = solved(open_a_box_and_move_it().unwrap());
    for path in &paths {
        assert_stays_in_its_states(&model, path);
        let names = states(&model, path);
        assert!(names.iter().any(|n| n == "arm/hand grasps chest/side"), "{names:?}");
        assert!(names.iter().any(|n| n == "arm/hand grasps chest/knob"), "{names:?}");
    }
}

#[test]
fn a_target_that_does_not_hold_at_the_start_is_refused_not_asserted() {
    // `step` now lies within `standing`: a robot that stands could step, and none that starts lifted does.
    let mut problem = make_a_step().unwrap();
    problem.graph.transitions.remove(0);
    problem.graph.transitions[0].legs[0].within = 0;
    problem.start[5] += 0.3;
    let model = common::model(problem);
    let step = model.graph.transition_named("step | lifted").unwrap();
    assert!(model.graph.transition_named("step | lifted_ls").is_none(), "there is nothing to aim at");
    let settings = seeded(1).with(|s| s.max_steps = 30);
    let (outcome, mut search) = search(&model, &Mrrt, settings, 1);
    assert_eq!(outcome, SearchOutcome::StepLimit);
    let (_, statistics) = search.statistics().into_iter().find(|(id, _)| *id == step).unwrap();
    assert!(statistics.attempts > 0);
    assert_eq!(statistics.rejections.get(&Rejection::ProjectionFailed(0)), Some(&statistics.attempts));
}

#[test]
fn what_turns_freely_in_the_hand_is_carried_too() {
    // Free rotation, frozen while held; and not even frozen: then the box is no longer eliminated.
    for frozen in [true, false] {
        let mut problem = move_one_box().unwrap();
        for handle in &problem.graph.objects[0].handles {
            let handle = &mut problem.robot.handles[handle.at()];
            handle.mask = [true, true, true, false, false, false];
            handle.mask_complement = [false, false, false, frozen, frozen, frozen];
        }
        let (model, paths) = solved(problem);
        let grasp = model.graph.state_named("arm/hand grasps box0/top").unwrap();
        assert_eq!(model.graph.state(grasp).foliation.len(), usize::from(frozen));
        assert_eq!(model.carriers(grasp).of[0].is_some(), frozen);
        paths.iter().for_each(|path| assert_stays_in_its_states(&model, path));
    }
}

#[test]
fn margins_hold_except_where_a_grasp_or_a_placement_touches() {
    let mut problem = move_one_box().unwrap();
    let links = 0..problem.robot.links.len() as u32;
    let part = |link: u32| problem.robot.links[link as usize].part;
    let pairs = links.clone().flat_map(|a| links.clone().map(move |b| (a, b)));
    let apart: Vec<_> = pairs.filter(|&(a, b)| a < b && part(a) != part(b)).collect();
    let margin = |(a, b)| Margin { first: LinkIndex(a), second: LinkIndex(b), distance: 0.02 };
    problem.margins = apart.into_iter().map(margin).collect();
    let (model, paths) = solved(problem);
    let transition = |q: &[f64], id| {
        let bodies = bodies(&model, q);
        model.first_collision_along(id, &bodies, 0.0, &mut CollisionScratch::new())
    };
    for path in &paths {
        for segment in &path.segments {
            assert!(segment.knots.iter().all(|q| transition(q, segment.transition).is_none()));
        }
        // Beyond the margins.
        assert!(path.certificate.min_clearance.is_some_and(|c| c > 0.0));
    }
}
