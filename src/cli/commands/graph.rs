//! `foliate graph`: the constraint graph of a scene as text, DOT or Mermaid.

use crate::cli::console::loading;
use crate::cli::console::print::{Ending, Refusal, print};
use foliate::components::graph::{ConstraintGraph, TransitionKind};
use foliate::components::problem::Problem;
use foliate::inspection::{diagram, words};
use foliate::scene::{PackagePath, Scene};
use foliate::systems::planning_model::graph::checks::{GraphError, MOST_STATES};
use foliate::systems::planning_model::graph::enumeration::build_constraint_graph;
use foliate::systems::planning_model::{Model, PlanningModel};
use foliate::systems::settings::SearchSettings;
use std::fmt::Write;
use std::sync::Arc;
use std::time::Duration;

/// Shows the constraint graph of a scene
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A shipped scene's name, or a scene file
    scene: String,
    /// Graphviz DOT, for `dot -Tsvg`
    #[arg(long, conflicts_with = "mermaid")]
    dot: bool,
    /// Mermaid, for Markdown pages
    #[arg(long)]
    mermaid: bool,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let (name, mine) = (arguments.scene.clone(), packages.clone());
    let Ok(graph) = loading::beside(Duration::MAX, Duration::ZERO, move |stop| {
        let scene = Scene::load(&name, &loading::until(&mine, stop))?;
        Ok(shown(scene.problem)?)
    })?
    else {
        return Ok(Ending::Interrupted);
    };
    print(&match (arguments.dot, arguments.mermaid) {
        (true, _) => diagram::dot(&graph),
        (_, true) => diagram::mermaid(&graph),
        (false, false) => listing(&graph),
    });
    Ok(Ending::Done)
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
    let state = model.reach(&start, tolerance).ok_or_else(|| {
        Refusal(format!(
            "the graph has more than {MOST_STATES} states, and the start lies in none, so that none is shown"
        ))
    })?;
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
        let names = |ids: &[foliate::components::graph::ConstraintId]| {
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
