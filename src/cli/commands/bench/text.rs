//! What `bench` prints: rows while it runs, and one object in the end.

use crate::batch::improvement::{ImprovementTable, Moment, SceneImprovement};
use crate::batch::{Row, SceneSummary, Spread, Table};
use serde_json::{Value, json};

/// A row while the batch runs.
pub(super) fn line(row: &Row) -> String {
    let nodes = row.work.map(|work| format!(", {} nodes", work.nodes)).unwrap_or_default();
    let why = if row.message.is_empty() { String::new() } else { format!(": {}", row.message.escape_debug()) };
    let (scene, seed, time) = (&row.scene, row.seed, row.solve_time.as_secs_f64());
    let answer = row.answer.as_ref().map(|answer| {
        let duration = answer.duration.map_or_else(|| "no times".into(), |duration| format!("{duration:.2} s"));
        format!("; {duration}, {} grasp changes", answer.grasp_changes)
    });
    let which = label(row);
    format!("{scene} {which}{seed}: {} in {time:.3} s{nodes}{}{why}\n", row.outcome.name(), answer.unwrap_or_default())
}

/// What tells a row from others of the same scene and seed, where there are others.
fn label(row: &Row) -> String {
    let mut words = Vec::new();
    words.extend((!row.settings.is_empty()).then(|| format!("{} {}", row.scheduler, row.settings)));
    words.extend(row.instance.map(|instance| format!("instance {instance}")));
    if words.is_empty() { String::new() } else { format!("({}) ", words.join(", ")) }
}

fn improvement(table: &ImprovementTable) -> Value {
    let moment = |m: &Moment| {
        let at = m.at.map(|at| at.as_secs_f64());
        json!({ "checkpoint": at, "shortest": m.shortest, "median": m.median, "longest": m.longest })
    };
    let scene = |s: &SceneImprovement| {
        json!({
            "scene": s.scene,
            "fewest_grasp_changes": s.fewest_grasp_changes,
            "grasp_ratios": s.grasp_ratios,
            "best_duration": s.best_duration,
            "durations": s.moments.iter().map(moment).collect::<Vec<_>>(),
        })
    };
    json!({
        "budget": table.measurement.budget().to_string(),
        "scenes": table.scenes.iter().map(scene).collect::<Vec<_>>(),
        "grasp_ratio_95": table.grasp_ratio_95(),
        "cut": table.cut,
        "untimed": table.untimed,
    })
}

pub(super) fn object(table: &Table, rows: &[Row]) -> Value {
    let spread = |s: Option<Spread>| s.map(|s| json!({ "min": s.min, "median": s.median, "max": s.max }));
    let scene = |s: &SceneSummary| {
        json!({
            "scene": s.scene,
            "solved": s.solved,
            "runs": s.runs,
            "time_s": spread(s.time),
            "nodes": spread(s.nodes),
        })
    };
    let scenes: Vec<Value> = table.scenes.iter().map(scene).collect();
    let groups = table.groups.iter().map(
        |group| json!({ "scheduler": group.scheduler, "settings": group.settings, "summary": scene(&group.summary) }),
    );
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "machine": table.machine.to_string(),
        "date": table.date,
        "scheduler": table.scheduler,
        "simd": table.search.level.name(),
        "candidates": table.search.candidates,
        "selection": format!("{:?}", table.search.selection),
        "seeds": table.seeds.to_string(),
        "threads": table.threads,
        "time_limit_s": table.time_limit.as_secs_f64(),
        "scenes": scenes,
        "groups": groups.collect::<Vec<_>>(),
        "instances": table.instances,
        "refused": table.refused.to_string(),
        "improvement": table.improvement.as_ref().map(improvement),
        "rows": rows.iter().map(Row::json).collect::<Vec<_>>(),
    })
}
