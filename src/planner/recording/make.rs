//! From the answer of a planner to a recording.

use crate::path_file::document::PathFile;
use crate::path_file::write::{PathContext, write_path};
use crate::planner::answer::{NoSolution, Solution, outcome_name};
use crate::planner::recording::document::{
    CountsEntry, FORMAT, LeftOutEntry, MemberEntry, Recording, RecordingHead, RootsEntry,
};
use crate::planner::recording::findings::findings;
use crate::planner::recording::funnel_rows::{FunnelRows, goal_search};
use crate::planner::recording::graph_rows::GraphRows;
use crate::planner::report::Report;
use crate::planner::search_record::{DEFAULT_RECORDING_BYTES, SearchRecord};
use foliate_components::path::ManipulationPath;
use foliate_components::problem::Goal;
use foliate_schedulers::portfolio::MemberCount;

/// What numbers of the head may grow by once the columns are fitted in behind it, bytes.
const SLACK: u64 = 256;

impl Recording {
    /// The recording of a solve, whether it found a path or not. The planner must have been asked to record
    /// ([`Planner::record`](crate::Planner::record)): else, and after a crash, there is no roadmap in it and no funnel.
    ///
    /// The context is that of a path file ([`write_path`]); its graph is that of the answer's model. A file of the recording is no larger
    /// than the planner was told, as long as what path files say of the models fits.
    ///
    /// ```
    /// use foliate::path_file::{PathContext, save};
    /// use foliate::recording::Recording;
    /// use foliate::{Planner, scene::{PackagePath, Scene}};
    ///
    /// let scene = Scene::load("demo", &PackagePath::default())?;
    /// let planner = Planner::new(scene.problem.clone())?.seed(3).first_path().record();
    /// let answer = planner.solve();
    /// # let folder = std::env::temp_dir().join(format!("foliate-recording-{}", std::process::id()));
    /// # std::fs::create_dir_all(&folder)?;
    /// let out = folder.join("demo.search");
    /// let graph = match &answer {
    ///     Ok(solution) => &solution.model.graph,
    ///     Err(none) => &none.model.graph,
    /// };
    /// let models = save::model_names(&scene, &out)?;
    /// let context =
    ///     PathContext { problem: &scene.problem, graph, models: &models, seed: 3, scheduler: "sequence", simd: "detected" };
    /// Recording::of(&context, &answer).save(&out)?;
    ///
    /// let recording = Recording::read(&out)?;
    /// assert_eq!(recording.head.outcome, "solved");
    /// println!("{} nodes; {}", recording.nodes.len(), recording.words().join(" "));
    /// # std::fs::remove_dir_all(&folder)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(context: &PathContext<'_>, answer: &Result<Solution, NoSolution>) -> Self {
        let (record, path) = match answer {
            Ok(solution) => (solution.record.as_deref(), Some(&solution.path)),
            Err(none) => (none.record.as_deref(), None),
        };
        let mut record = record.cloned().unwrap_or_else(|| nothing_of(context));
        let mut file = path_file(context, path.unwrap_or(&ManipulationPath::default()));
        let most = record.most_bytes;
        let path_left_out = path.is_some() && length(&file) > most / 2;
        if path_left_out {
            file = path_file(context, &ManipulationPath::default());
        }
        let rows = GraphRows::new(context.graph, Some(&record), most / 4);
        let funnel = FunnelRows::new(&context.problem.robot, &record, &rows, most / 8);
        let report = Report::of(answer);
        let (goals, goal_pairs_left_out) = goal_search(&context.problem.robot, &report.goals.statistics);
        let mut recording = Self {
            head: RecordingHead {
                format: FORMAT.into(),
                outcome: outcome_name(answer).into(),
                reason: answer.as_ref().err().map(|none| none.reason.to_string()),
                counts: counts(report, &record),
                left_out: LeftOutEntry {
                    states: rows.states_left_out,
                    transitions: rows.transitions_left_out,
                    funnel: funnel.rows_left_out,
                    pairs: funnel.pairs_left_out + goal_pairs_left_out,
                    collisions: funnel.collisions_left_out,
                    path: path_left_out,
                    ..LeftOutEntry::default()
                },
                members: report.worlds.iter().map(member).collect(),
                findings: answer.as_ref().err().map(|none| findings(&none.reason)).unwrap_or_default(),
                start: whole(context, &context.problem.start),
                goals: whole_goals(context),
                goal_search: goals,
                roots: RootsEntry::default(),
                states: rows.states.clone(),
                transitions: rows.transitions.clone(),
                funnel: funnel.rows,
                width: record.width,
                still: still(context),
                nodes: 0,
                edges: 0,
                collisions: (funnel.collisions.len() / record.width.max(1)) as u64,
                path: file,
            },
            nodes: Default::default(),
            edges: Default::default(),
            collisions: funnel.collisions,
        };
        let head = length(&recording.head) + SLACK + 12 * record.goals.len() as u64;
        record.fit(most.saturating_sub(head + 4 * recording.collisions.len() as u64));
        recording.take_columns(record, &rows);
        recording
    }

    /// Takes the nodes and edges of a record, which refer to rows of the graph from now on.
    fn take_columns(&mut self, record: SearchRecord, rows: &GraphRows) {
        let SearchRecord { nodes, edges, start, goals, nodes_left_out, edges_left_out, .. } = record;
        (self.nodes, self.edges) = (nodes, edges);
        self.nodes.states.iter_mut().for_each(|state| *state = rows.state(*state));
        self.edges.transitions.iter_mut().for_each(|along| *along = rows.transition(*along));
        self.head.roots = RootsEntry { start, goals };
        (self.head.nodes, self.head.edges) = (self.nodes.len() as u64, self.edges.len() as u64);
        (self.head.left_out.nodes, self.head.left_out.edges) = (nodes_left_out, edges_left_out);
    }
}

/// The record of a solve of which nothing is known but its outcome.
fn nothing_of(context: &PathContext<'_>) -> SearchRecord {
    let width = context.problem.robot.space.size();
    SearchRecord { most_bytes: DEFAULT_RECORDING_BYTES, width, ..SearchRecord::default() }
}

fn path_file(context: &PathContext<'_>, path: &ManipulationPath) -> PathFile {
    write_path(context, path)
}

/// How many bytes of JSON something takes.
fn length(value: &impl serde::Serialize) -> u64 {
    /// Counts what is written.
    struct Counter(u64);
    impl std::io::Write for Counter {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0 += bytes.len() as u64;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut counter = Counter(0);
    let _as_far_as_it_goes = serde_json::to_writer(&mut counter, value);
    counter.0
}

fn counts(report: &Report, record: &SearchRecord) -> CountsEntry {
    CountsEntry {
        steps: report.steps,
        candidates: report.candidates,
        validated: report.validated,
        nodes: report.nodes as u64,
        edges: report.edges as u64,
        leaves: report.leaves as u64,
        trees: record.trees as u64,
    }
}

fn member(count: &MemberCount) -> MemberEntry {
    MemberEntry {
        scheduler: count.scheduler.into(),
        answers: count.answers,
        steps: count.counter.step,
        candidates: count.counter.candidates,
    }
}

/// Where the joints of environments stand that are coordinates of path files and not of problems.
fn still(context: &PathContext<'_>) -> Vec<f64> {
    context.models.parts.iter().flat_map(|part| part.joint_values.iter().map(|(_, value)| *value)).collect()
}

/// A configuration by coordinate of the path file; none of what is no configuration.
fn whole(context: &PathContext<'_>, q: &[f64]) -> Option<Vec<f64>> {
    let fits = q.len() == context.problem.robot.space.size() && q.iter().all(|x| x.is_finite());
    fits.then(|| [q, &still(context)].concat())
}

fn whole_goals(context: &PathContext<'_>) -> Vec<Vec<f64>> {
    let goal = |goal: &Goal| match goal {
        Goal::Configuration(q) => whole(context, q),
        _ => None,
    };
    context.problem.goals.iter().filter_map(goal).collect()
}
