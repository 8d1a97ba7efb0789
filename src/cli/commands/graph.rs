//! `foliate graph`: the constraint graph of a scene as text, as a picture, as DOT or Mermaid.

use crate::cli::console::loading;
use crate::cli::console::outputs;
use crate::cli::console::print::{Ending, Refusal, print};
use crate::components::graph::{ConstraintGraph, TransitionKind};
use crate::components::problem::Problem;
use crate::inspection::{diagram, words};
use crate::output;
use crate::scene::{PackagePath, Scene};
use crate::systems::planning_model::graph::checks::{GraphError, MOST_STATES};
use crate::systems::planning_model::graph::enumeration::build_constraint_graph;
use crate::systems::planning_model::{Model, PlanningModel};
use crate::systems::settings::SearchSettings;
use crate::view::{PictureOptions, grown_graph, picture, svg};
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Shows the constraint graph of a scene
#[derive(clap::Args, Clone)]
pub(crate) struct Arguments {
    /// A shipped scene's name, or a scene file
    scene: String,
    /// Graphviz DOT, for `dot -Tsvg`
    #[arg(long, conflicts_with_all = ["mermaid", "svg"])]
    dot: bool,
    /// Mermaid, for Markdown pages
    #[arg(long, conflicts_with = "svg")]
    mermaid: bool,
    /// A picture: SVG, laid out by the program itself
    #[arg(long)]
    svg: bool,
    /// Show waypoints in the picture as boxes of their own
    #[arg(long, requires = "svg")]
    waypoints: bool,
    /// Write to this file instead of standard output
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    outputs::check([&*arguments.scene], &arguments.out)?;
    let (mine, packages) = (arguments.clone(), packages.clone());
    let Ok(text) = loading::beside(Duration::MAX, Duration::ZERO, move |stop| {
        let scene = Scene::load(&mine.scene, &loading::until(&packages, stop))?;
        Ok(match mine.svg {
            true => drawn(&mine, &scene.problem)?,
            false => {
                let graph = shown(scene.problem)?;
                match (mine.dot, mine.mermaid) {
                    (true, _) => diagram::dot(&graph),
                    (_, true) => diagram::mermaid(&graph),
                    (false, false) => listing(&graph),
                }
            }
        })
    })?
    else {
        return Ok(Ending::Interrupted);
    };
    match &arguments.out {
        Some(out) => output::write(out, text.as_bytes()).map_err(|e| Refusal(format!("{}: {e}", out.display())))?,
        None => print(&text),
    }
    Ok(Ending::Done)
}

/// The graph as SVG.
fn drawn(arguments: &Arguments, problem: &Problem) -> Result<String, Refusal> {
    let graph = grown_graph(problem).map_err(|e| Refusal(e.to_string()))?;
    if graph.states.is_empty() {
        return Err(Refusal(nothing_to_show()));
    }
    let options = PictureOptions { waypoints: arguments.waypoints, ..PictureOptions::default() };
    let picture = picture(&graph, &words::ShortNames::of(&problem.robot, &graph), &options);
    Ok(svg(&picture, &format!("The constraint graph of {}", problem.name)))
}

fn nothing_to_show() -> String {
    format!("the graph has more than {MOST_STATES} states, and the start lies in none, so that none is shown")
}

/// The whole graph; of one that is too large, what surrounds the start.
fn shown(problem: Problem) -> Result<ConstraintGraph, Refusal> {
    match build_constraint_graph(&problem) {
        Ok(graph) => return Ok(graph),
        Err(GraphError::TooManyStates { .. }) => {}
        Err(other) => return Err(Refusal(other.to_string())),
    }
    let start = problem.start.clone();
    let mut model = PlanningModel(Arc::new(Model::new_lazy(problem).map_err(|e| Refusal(e.to_string()))?));
    let tolerance = SearchSettings::default().classification_tolerance;
    let state = model.reach(&start, tolerance).ok_or_else(|| Refusal(nothing_to_show()))?;
    model.expand(state);
    Ok(model.graph.clone())
}

/// What the words of the listing mean.
const LEGEND: &str = "\
Each state lists its constraints, those whose values distinguish its leaves, and the transitions that leave it. A leg is
a motion on one leaf. The weight is the relative probability among the transitions of a state. In brackets: the name in
path files. A transition onto a leaf of another tree takes the new values from a leaf that this tree has reached.
";

/// States with their constraints, and the transitions that leave each.
fn listing(graph: &ConstraintGraph) -> String {
    let count = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
    let states = graph.states_of_nodes().count();
    let (states, transitions) = (count(states, "state"), count(graph.transitions.len(), "transition"));
    let mut out = format!("{states}, {transitions}\n");
    if graph.lazy {
        out = format!(
            "more than {MOST_STATES} states: the graph grows while it is searched; these are the start's state and its \
             neighbours\n{out}"
        );
    }
    out.push_str(LEGEND);
    for (id, state) in graph.states_of_nodes() {
        let names = |ids: &[crate::components::graph::ConstraintId]| {
            ids.iter().map(|&c| graph.constraint(c).name.clone()).collect::<Vec<_>>().join(", ")
        };
        let _ = writeln!(out, "\nstate {}", state.name);
        let or = |names: String, nothing: &str| if names.is_empty() { nothing.to_owned() } else { names };
        let _ = writeln!(out, "  constraints: {}", or(names(&state.manifold), "none"));
        let _ =
            writeln!(out, "  constant on a leaf: {}", or(names(&state.foliation), "nothing, the state is one leaf"));
        if !graph.is_expanded(id) {
            let _ = writeln!(out, "  not expanded yet");
        }
        for (_, t) in graph.leaving(id) {
            let to = match t.kind {
                TransitionKind::Loop => String::new(),
                TransitionKind::Regular | TransitionKind::Crossed => format!(" → {}", graph.state(t.to).name),
            };
            let legs = count(t.legs.len(), "leg");
            let _ = writeln!(out, "  {}{to} ({legs}, weight {:.3}) [{}]", words::action(t), t.weight, t.name);
        }
    }
    out
}
