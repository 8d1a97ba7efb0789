//! Why there is no path, for people: what was asked, how far the search got from either side, and what may help.

use crate::cli::commands::solve::answer::Answer;
use crate::components::graph::{ConstraintGraph, TransitionKind};
use crate::components::outcome::SideTries;
use crate::components::pose::pose_to_array;
use crate::components::problem::{Goal, Holding, ObjectOptions, PartialGoal, Problem};
use crate::components::robot::Source;
use crate::inspection::words;
use crate::systems::goals::impossible::hindrance::{Blocked, Hindrance, OutOfReach, Shortfall};
use crate::{FunnelRow, ObjectTries, Report};
use std::fmt::Write;

/// Goals that are told in words.
const MOST_GOALS: usize = 3;
/// An object that is nearer to its start is not told.
const MOVED: f64 = 1e-3;

/// The report on a search that ended without a path.
pub(crate) fn text(answer: &Answer) -> String {
    let (report, model) = (answer.report(), answer.model());
    let mut out = String::from("  asked:\n");
    for line in asked(&model.problem) {
        let _ = writeln!(out, "    {line}");
    }
    out.push_str("  how far it got:\n");
    report.objects.iter().for_each(|row| out.push_str(&never_grasped(row)));
    for (side, name) in ["the start", "the goal"].into_iter().enumerate() {
        let _ = writeln!(out, "    from {name}: {}", bottleneck(report, &model.graph, side));
    }
    out.push_str("  what may help:\n");
    for line in advice(report) {
        let _ = writeln!(out, "    {line}");
    }
    out
}

/// What the goals ask, a line each.
fn asked(problem: &Problem) -> Vec<String> {
    let told = problem.goals.iter().take(MOST_GOALS).map(|goal| match goal {
        Goal::Configuration(q) => whole(problem, q),
        Goal::Partial(goal) => partial(problem, goal),
    });
    let mut lines: Vec<String> = told.collect();
    if let Some(more) = problem.goals.len().checked_sub(MOST_GOALS).filter(|more| *more > 0) {
        lines.push(format!("or one of {more} goals more"));
    }
    lines
}

/// A whole configuration: where it has the objects that it moves.
fn whole(problem: &Problem, q: &[f64]) -> String {
    let robot = &problem.robot;
    let of_object = |object: &ObjectOptions| {
        let part = &robot[object.part];
        let Source::Coordinates { q: first, .. } = robot[part.root_joint?].source else { return None };
        let (was, now) = (problem.start.get(first..first + 3)?, q.get(first..first + 3)?);
        let distance = was.iter().zip(now).map(|(was, now)| (now - was).powi(2)).sum::<f64>().sqrt();
        (distance > MOVED).then(|| format!("{} at {}, {distance:.3} m from where it starts", part.name, position(now)))
    };
    let moved: Vec<String> = problem.graph.objects.iter().filter_map(of_object).collect();
    match moved.is_empty() {
        true => "a whole configuration of the robots, with the objects where they start".into(),
        false => format!("a whole configuration: {}", moved.join("; ")),
    }
}

fn position(at: &[f64]) -> String {
    let numbers: Vec<String> = at.iter().map(|x| format!("{x:.3}")).collect();
    format!("({})", numbers.join(", "))
}

fn partial(problem: &Problem, goal: &PartialGoal) -> String {
    let robot = &problem.robot;
    let mut asks = Vec::new();
    for (part, pose) in &goal.poses {
        asks.push(format!("{} at {}", robot[*part].name, position(&pose_to_array(pose)[..3])));
    }
    for (part, supports) in &goal.lying {
        let names: Vec<&str> = supports.iter().map(|support| robot.surfaces[support.at()].name.as_str()).collect();
        asks.push(format!("{} on {}", robot[*part].name, names.join(" or ")));
    }
    for &(gripper, holding) in &goal.hands {
        let hand = &robot.grippers[gripper.at()].name;
        asks.push(match holding {
            Holding::Nothing => format!("{hand} empty"),
            Holding::Anything => format!("{hand} with whatever it holds"),
            Holding::Object(part) => format!("{hand} holding {}", robot[part].name),
            Holding::Handle(handle) => format!("{hand} holding {}", robot.handles[handle.at()].name),
        });
    }
    asks.extend(goal.held.iter().map(|&part| format!("{} held", robot[part].name)));
    asks.extend(goal.constraints.iter().map(|named| format!("constraint {}", named.name)));
    let numbers = goal.coordinates.len() + goal.near.len();
    if numbers > 0 {
        asks.push(format!("{numbers} joint values"));
    }
    if asks.is_empty() { "nothing".into() } else { asks.join("; ") }
}

/// Why an object that has to be moved was never grasped where it starts, or where the goal has it.
fn never_grasped(row: &ObjectTries) -> String {
    let mut out = String::new();
    let both = [
        (&row.start, &row.goal, "where it starts", &row.start_hindrance),
        (&row.goal, &row.start, "where the goal has it", &row.goal_hindrance),
    ];
    for (side, other, place, hindrance) in both.into_iter().filter(|(side, ..)| side.reached == 0) {
        if side.tries == 0 && hindrance.is_none() {
            continue;
        }
        let _ = write!(out, "    `{}` was never grasped {place}: {} tries{}", row.object, side.tries, shares(side));
        if let (Some((first, second, _)), 0) = (&row.blocked_by, other.in_collision) {
            let _ = write!(out, ", most often {first} with {second}");
        }
        out.push('\n');
        if let Some(hindrance) = hindrance {
            let _ = writeln!(out, "      likely: {hindrance}");
        }
    }
    if let Some(why) = &row.no_common_grasp {
        let _ = writeln!(out, "    likely no grasp takes `{}` from start to goal: {why}", row.object);
    }
    out
}

/// What stopped the tries of a side, in per cent.
fn shares(side: &SideTries) -> String {
    let percent = |count: u64| 100.0 * count as f64 / side.tries.max(1) as f64;
    let mut out = String::new();
    if side.out_of_reach > 0 {
        let reach = "out of reach (no configuration within the joint limits was found)";
        let _ = write!(out, ", {:.0} % {reach}", percent(side.out_of_reach));
    }
    if side.in_collision > 0 {
        let _ = write!(out, ", {:.0} % in collision", percent(side.in_collision));
    }
    out
}

/// The transition that stops the trees of a side: of those that never succeeded the one that was tried most, else the one that succeeded
/// most seldom.
fn bottleneck(report: &Report, graph: &ConstraintGraph, side: usize) -> String {
    let transition = |row: &FunnelRow| graph.transitions.iter().find(|transition| transition.name == row.transition);
    let leads_on = |row: &&FunnelRow| transition(row).is_some_and(|found| found.kind != TransitionKind::Loop);
    let rows = report.funnel.iter().filter(leads_on);
    let tried: Vec<&FunnelRow> = rows.filter(|row| row.statistics.sides[side].tries > 0).collect();
    let side_of = |row: &FunnelRow| row.statistics.sides[side];
    let never = tried.iter().filter(|row| side_of(row).reached == 0);
    let rate = |row: &FunnelRow| side_of(row).reached as f64 / side_of(row).tries as f64;
    let hardest = never
        .max_by(|a, b| side_of(a).tries.cmp(&side_of(b).tries).then_with(|| b.transition.cmp(&a.transition)))
        .or_else(|| {
            tried.iter().min_by(|a, b| rate(a).total_cmp(&rate(b)).then_with(|| a.transition.cmp(&b.transition)))
        });
    let Some(row) = hardest else { return "no transition was tried".into() };
    let SideTries { tries, reached, .. } = side_of(row);
    let mut told = format!("hardest is {}: {reached} of {tries} tries succeeded", described(&row.transition, graph));
    told += &shares(&side_of(row));
    if let Some((first, second, _)) = row.blocked_by.first().filter(|_| side_of(row).in_collision > 0) {
        let _ = write!(told, ", most often {first} with {second}");
    }
    told
}

/// A transition in words, with the state that it leaves, and its name.
pub(crate) fn described(name: &str, graph: &ConstraintGraph) -> String {
    match graph.transitions.iter().find(|transition| transition.name == name) {
        Some(transition) => {
            let from = words::situation(&graph.state(transition.from).name);
            format!("\"{}\", while {from} ({name})", words::action(transition))
        }
        None => name.to_owned(),
    }
}

/// What a user may change, most helpful first.
fn advice(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    for row in &report.objects {
        for (hindrance, place) in [(&row.start_hindrance, "starts"), (&row.goal_hindrance, "shall be")] {
            lines.extend(hindrance.as_ref().map(|hindrance| remedy(hindrance, &row.object, place)));
        }
        if row.no_common_grasp.is_some() {
            lines.push(format!(
                "give `{}` a handle that a hand reaches both where it starts and where it shall be, or a support between the two",
                row.object
            ));
        }
    }
    lines.push("more time: --time-limit SECONDS".into());
    lines.push(
        "see where the search got to: --record FILE.search, then foliate view FILE.search; --verbose counts all tries"
            .into(),
    );
    lines
}

fn remedy(hindrance: &Hindrance, object: &str, place: &str) -> String {
    match hindrance {
        Hindrance::OutOfReach(OutOfReach { handle, shortfall: Shortfall::Limit { joint, needed, limit }, .. }) => {
            format!(
                "let {joint} move to {needed:.4} instead of {limit:.4} (`joint_bounds`, or its limit in the URDF), or turn {handle}"
            )
        }
        Hindrance::OutOfReach(OutOfReach { shortfall: Shortfall::Distance(off), .. }) => format!(
            "move the place where `{object}` {place}, or the robot, nearer by {:.0} mm or more, or add handles on other sides",
            off * 1e3
        ),
        Hindrance::OutOfReach(_) => format!("move the support on which `{object}` {place}, or the robot, nearer"),
        Hindrance::Blocked(Blocked { obstacle, links: (first, second), .. }) => format!(
            "move {obstacle} away from where `{object}` {place}, or add handles on other sides; if these links may touch: \
             ignore = [[\"{first}\", \"{second}\"]]"
        ),
        _ => format!("look at where `{object}` {place}"),
    }
}
