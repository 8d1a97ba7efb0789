//! What a search has found, as JSON for machines.

use crate::cli::commands::solve::answer::Answer;
use crate::cli::commands::solve::arguments::SearchArguments;
use crate::cli::commands::solve::coverage;
use crate::cli::commands::solve::summary::{Loaded, name};
use crate::components::outcome::SideTries;
use crate::components::path::{ManipulationPath, events};
use crate::components::problem::{Correction, Moved};
use crate::planner::{CostRow, ImprovementReport};
use crate::schedulers::portfolio::MemberCount;
use crate::{FunnelRow, GoalReport, NoSolutionReason, ObjectTries, StateRow};
use serde_json::{Value, json};

fn closest_json(loaded: &Loaded<'_>) -> Option<Value> {
    let clearance = loaded.clearance?;
    let nearest = clearance.nearest.as_ref();
    Some(json!({
        "lower": clearance.lower,
        "upper": nearest.map(|n| n.clearance),
        "first": nearest.map(|n| name(loaded, n.shapes.0)),
        "second": nearest.map(|n| name(loaded, n.shapes.1)),
        "segment": nearest.map(|n| n.segment),
        "t": nearest.map(|n| n.t),
    }))
}

/// The summary for machines: one object, with wall times and counts.
pub(crate) fn json(loaded: &Loaded<'_>, search: &SearchArguments, answer: &Answer) -> Value {
    let report = answer.report();
    let reason = answer.reason().and_then(NoSolutionReason::detail);
    let certificate = answer.path().map(|path| {
        let c = &path.certificate;
        json!({
            "path_tolerance": c.path_tolerance,
            "max_residual": c.max_residual,
            "min_clearance": c.min_clearance,
            "joint_limits": "within",
            "pairs": coverage::counts_json(&c.pairs),
        })
    });
    let left_out =
        loaded.left_out.map(|left| coverage::list_json(&left.pairs, &left.apart, |shape| name(loaded, shape)));
    let funnel: Vec<Value> = report.funnel.iter().map(funnel_json).collect();
    let states: Vec<Value> = report.states.iter().map(state_json).collect();
    json!({
        "scene": loaded.scene.problem.name,
        "seed": search.seed,
        "scheduler": search.scheduler,
        "threads": search.threads,
        "simd": search.tuning.level.name(),
        "outcome": answer.name(),
        "reason": reason,
        "load_ms": loaded.load_time.as_secs_f64() * 1e3,
        "solve_ms": report.time().as_secs_f64() * 1e3,
        "steps": report.steps,
        "candidates": report.candidates,
        "validated": report.validated,
        "worlds": report.worlds.iter().map(world_json).collect::<Vec<_>>(),
        "nodes": report.nodes,
        "edges": report.edges,
        "leaves": report.leaves,
        "segments": answer.path().map(|p| p.segments.len()),
        "path_length": report.path_length,
        "grasp_changes": answer.path().map(|path| events(path).len()),
        "duration": answer.path().and_then(ManipulationPath::duration),
        "timing_ms": report.timing_time.as_secs_f64() * 1e3,
        "snapped": report.snapped.iter().map(snapped_json).collect::<Vec<_>>(),
        "untimed": report.untimed.as_ref().map(ToString::to_string),
        "improvement": report.improvement.as_ref().map(improvement_json),
        "roadmap": format!("{:016x}", report.fingerprint),
        "funnel": funnel,
        "states": states,
        "goals": goals_json(&report.goals),
        "objects": report.objects.iter().map(object_json).collect::<Vec<_>>(),
        "certificate": certificate,
        "clearance": closest_json(loaded),
        "pairs_left_out": left_out,
    })
}

fn snapped_json(snapped: &Correction) -> Value {
    let name = |is_object: bool| (matches!(snapped.moved, Moved::Object(..)) == is_object).then_some(&snapped.name);
    json!({
        "goal": snapped.goal,
        "object": name(true),
        "joint": name(false),
        "onto": snapped.onto,
        "distance": snapped.distance,
        "angle": snapped.angle,
    })
}

fn improvement_json(report: &ImprovementReport) -> Value {
    let row = |row: &CostRow| json!({ "work": row.work, "ms": row.time.as_secs_f64() * 1e3, "cost": row.cost });
    json!({
        "cost": report.cost,
        "first_cost": report.first_cost,
        "final_cost": report.final_cost,
        "work": report.work,
        "ms": report.time.as_secs_f64() * 1e3,
        "shortcuts": report.changes.shortcuts,
        "limb_shortcuts": report.changes.limb_shortcuts,
        "waypoint_moves": report.changes.waypoint_moves,
        "leaf_moves": report.changes.leaf_moves,
        "replanned": report.changes.replanned,
        "stopped": report.stopped,
        "history": report.history.iter().map(row).collect::<Vec<_>>(),
    })
}

fn world_json(world: &MemberCount) -> Value {
    json!({
        "scheduler": world.scheduler,
        "answers": world.answers,
        "steps": world.counter.step,
        "candidates": world.counter.candidates,
        "validated": world.counter.validated,
    })
}

fn funnel_json(row: &FunnelRow) -> Value {
    let s = &row.statistics;
    let rejections: Vec<Value> = s
        .rejections
        .iter()
        .map(|(reason, count)| json!({ "reason": reason.describe(), "leg": reason.leg(), "count": count }))
        .collect();
    json!({
        "transition": row.transition,
        "attempts": s.attempts,
        "reached": s.reached,
        "partial": s.partial,
        "success_rate": row.success_rate,
        "projection_rate": row.projection_rate,
        "rejections": rejections,
        "blocked_by": row.blocked_by,
        "blocking_parts": row.blocking_parts,
    })
}

fn state_json(row: &StateRow) -> Value {
    let s = row.statistics;
    json!({
        "state": row.state,
        "nodes": s.nodes,
        "leaves": s.leaves,
        "extended": s.extended,
        "connections_tried": s.connections_tried,
        "connections_made": s.connections_made,
    })
}

/// What became of the tries to grasp an object that has to be moved.
fn object_json(row: &ObjectTries) -> Value {
    let side = |side: &SideTries| {
        json!({
            "tries": side.tries,
            "grasped": side.reached,
            "out_of_reach": side.out_of_reach,
            "in_collision": side.in_collision,
        })
    };
    json!({
        "object": row.object,
        "start": side(&row.start),
        "goal": side(&row.goal),
        "blocked_by": row.blocked_by,
        "start_hindrance": row.start_hindrance.as_ref().map(ToString::to_string),
        "goal_hindrance": row.goal_hindrance.as_ref().map(ToString::to_string),
        "no_common_grasp": row.no_common_grasp.as_ref().map(ToString::to_string),
    })
}

fn goals_json(goals: &GoalReport) -> Value {
    let s = &goals.statistics;
    json!({
        "tries": s.tries,
        "found": s.found,
        "projection_failed": s.projection_failed,
        "refused": s.refused,
        "blocking_parts": goals.blocking_parts,
    })
}
