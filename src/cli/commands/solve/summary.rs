//! What a search has found, as text for people. `summary_json` says the same as JSON.

use crate::cli::commands::solve::answer::Answer;
use crate::cli::commands::solve::coverage::LeftOut;
use crate::cli::commands::solve::{coverage, no_path, story};
use crate::components::graph::ConstraintGraph;
use crate::components::outcome::Rejection;
use crate::components::path::{ManipulationPath, events};
use crate::components::robot::ShapeIndex;
use crate::scene::Scene;
use crate::schedulers::portfolio::MemberCount;
use crate::systems::improvement::progress::Changes;
use crate::systems::search::path_clearance::PathClearance;
use crate::{FunnelRow, Report};
use std::fmt::Write;
use std::time::Duration;

/// A scene that was searched.
pub(crate) struct Loaded<'a> {
    pub scene: &'a Scene,
    /// Reading, graph building and tables.
    pub load_time: Duration,
    /// How close things come along the path, where that is asked.
    pub clearance: Option<&'a PathClearance>,
    /// The pairs that are left out, where they are asked for.
    pub left_out: Option<&'a LeftOut>,
    /// Whether counters of the search are printed.
    pub verbose: bool,
}

/// A distance as people read it.
pub(crate) fn distance(metres: f64) -> String {
    match metres.abs() {
        m if m >= 1.0 => format!("{metres:.2} m"),
        m if m >= 1e-3 => format!("{:.2} mm", metres * 1e3),
        _ => format!("{:.1} µm", metres * 1e6),
    }
}

/// The summary for people.
// Long: one line of the summary after another.
pub(crate) fn text(loaded: &Loaded<'_>, answer: &Answer) -> String {
    let report = answer.report();
    let graph = &answer.model().graph;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{}: {} in {} ({} loading)",
        loaded.scene.problem.name,
        answer.name().replace('_', " "),
        duration(report.time()),
        duration(loaded.load_time)
    );
    if let Some(path) = answer.path() {
        let _ = writeln!(
            out,
            "  path: {} motions, each on one leaf, with {} knots; joint travel {:.2} m (angles times reach)",
            path.segments.len(),
            path.segments.iter().map(|s| s.knots.len()).sum::<usize>(),
            report.path_length.unwrap_or_default()
        );
        out.push_str(&refinement(report, path));
        let c = &path.certificate;
        let clearance = match c.min_clearance {
            Some(clearance) => format!("all tested pairs keep their margins and at least {} more", distance(clearance)),
            None => "no pair of shapes was tested: nothing is said about collisions".to_owned(),
        };
        let _ = writeln!(
            out,
            "  certificate: joint limits kept; grasps, placements and constraints hold to {:.1e} (m, rad; allowed {:.1e}); {clearance}",
            c.max_residual, c.path_tolerance
        );
        let _ = writeln!(out, "  pairs of shapes: {}", coverage::sentence(&c.pairs));
        out.push_str(&closest(loaded, answer));
        let _ = writeln!(out, "  what happens:");
        out.push_str(&story::tell(answer.model(), path));
    }
    if let Some(left_out) = loaded.left_out {
        let _ = writeln!(out, "  not tested:");
        for pair in &left_out.pairs {
            let _ = writeln!(out, "    {}", coverage::line(pair, &left_out.apart, |shape| name(loaded, shape)));
        }
    }
    if answer.path().is_none() && !matches!(answer.reason(), Some(reason) if reason.is_infeasible()) {
        out.push_str(&no_path::text(answer));
    }
    if loaded.verbose {
        out.push_str(&counters(report, answer));
        out.push_str(&funnel(&report.funnel, graph));
    }
    out
}

/// Steps, sizes, and what each member of a portfolio did.
fn counters(report: &Report, answer: &Answer) -> String {
    let graph = &answer.model().graph;
    let mut out = format!(
        "  {} steps, {} candidates, {} nodes, {} edges, {} leaves; {} of {} states, {} transitions\n",
        report.steps,
        report.candidates,
        report.nodes,
        report.edges,
        report.leaves,
        if graph.lazy { "as much as was needed of the graph:" } else { "graph" },
        graph.states_of_nodes().count(),
        graph.transitions.len()
    );
    for world in &report.worlds {
        let MemberCount { scheduler, answers, counter } = world;
        let what = if *answers { ", answers" } else { "" };
        let (steps, candidates) = (counter.step, counter.candidates);
        let _ = writeln!(out, "    portfolio member {scheduler}: {steps} steps, {candidates} candidates{what}");
    }
    out
}

pub(crate) fn name<'a>(loaded: &'a Loaded<'_>, shape: ShapeIndex) -> &'a str {
    &loaded.scene.problem.robot.shapes[shape.at()].name
}

/// What the improvement has gained, and how long the path takes.
fn refinement(report: &Report, path: &ManipulationPath) -> String {
    let mut out = String::new();
    if let Some(improved) = &report.improvement {
        let Changes { shortcuts, limb_shortcuts, waypoint_moves, leaf_moves, replanned } = improved.changes;
        let _ = writeln!(
            out,
            "  improvement: estimated cost {:.2} -> {:.2} in {} (--improve-work {}): {} stretches planned again, {} shortcuts, {} of single limbs, {} grasps and {} leaves moved{}",
            improved.first_cost,
            improved.final_cost,
            duration(improved.time),
            improved.work,
            replanned,
            shortcuts,
            limb_shortcuts,
            waypoint_moves,
            leaf_moves,
            if improved.stopped { "; stopped before its budget was spent" } else { "" }
        );
    }
    if let Some(seconds) = path.duration() {
        let changes = events(path).len();
        let _ = writeln!(
            out,
            "  trajectory: {seconds:.2} s with {changes} grasps and releases, within limits of velocity and acceleration"
        );
    }
    if let Some(error) = &report.untimed {
        let _ = writeln!(out, "  no times: {error}");
    }
    out
}

/// Where things come closest, where that was asked.
fn closest(loaded: &Loaded<'_>, answer: &Answer) -> String {
    let Some((clearance, path)) = loaded.clearance.zip(answer.path()) else { return String::new() };
    let Some(nearest) = clearance.nearest else { return String::new() };
    let (first, second) = nearest.shapes;
    let pieces = path.segments[nearest.segment].knots.len().saturating_sub(1).max(1);
    format!(
        "  closest: {} and {}, {} beyond their margin (no pair anywhere less than {}), at {:.0} % of motion {} of {}\n",
        name(loaded, first),
        name(loaded, second),
        distance(nearest.clearance),
        distance(clearance.lower),
        100.0 * nearest.t / pieces as f64,
        nearest.segment + 1,
        path.segments.len()
    )
}

/// The funnel: what became of the candidates, per transition.
fn funnel(rows: &[FunnelRow], graph: &ConstraintGraph) -> String {
    let mut out = String::from(
        "  funnel (candidates by transition: tried → reached + kept in part; what stopped the rest, and on which leg: the \
         first, second, … motion of the transition):\n",
    );
    let mut rows: Vec<&FunnelRow> = rows.iter().collect();
    rows.sort_by(|a, b| b.statistics.attempts.cmp(&a.statistics.attempts).then(a.transition.cmp(&b.transition)));
    for row in rows {
        let s = &row.statistics;
        let name = no_path::described(&row.transition, graph);
        let _ = writeln!(out, "    {name}: {} → {} + {}", s.attempts, s.reached, s.partial);
        let mut reasons: Vec<_> = s.rejections.iter().collect();
        reasons.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
        for (reason, count) in reasons {
            let _ = writeln!(out, "      {count:>6}  {}", why(*reason));
        }
        for (a, b, count) in row.blocked_by.iter().take(5) {
            let _ = writeln!(out, "      {count:>6}  blocked by {a} and {b}");
        }
    }
    out
}

fn why(reason: Rejection) -> String {
    match reason.leg() {
        Some(leg) => format!("{} (leg {})", reason.describe(), leg + 1),
        None => reason.describe().to_owned(),
    }
}

fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 1.0 { format!("{:.1} ms", seconds * 1e3) } else { format!("{seconds:.2} s") }
}
