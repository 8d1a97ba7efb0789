//! The form of a recording: its head, as `serde` reads and writes it, and the columns behind it.

use crate::path_file::document::PathFile;
use crate::planner::search_record::{RecordedEdges, RecordedNodes};
use serde::{Deserialize, Serialize};

/// The value of `format`.
pub const FORMAT: &str = "foliate.search/1";

/// The place in a list of something that is left out of it.
pub(crate) const LEFT_OUT: u32 = u32::MAX;

/// A recorded search.
///
/// Configurations of nodes and collisions have the first [`RecordingHead::width`] coordinates of the path file, as 32-bit numbers; the others
/// stand still at [`RecordingHead::still`].
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// All but the columns.
    pub head: RecordingHead,
    /// The nodes of the roadmap, in the order in which they came.
    pub nodes: RecordedNodes,
    /// The edges between them.
    pub edges: RecordedEdges,
    /// Configurations at which pairs collided, end to end.
    pub collisions: Vec<f32>,
}

/// The head of a recording. Rows refer to each other by their places in the lists, from 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingHead {
    /// [`FORMAT`].
    pub format: String,
    /// `solved`, or why not: `timeout`, `step_limit`, `memory_limit`, `cancelled`, `infeasible_start`, `infeasible_goal`, `crashed`, `failed`.
    pub outcome: String,
    /// The reason in words; none where it is solved.
    pub reason: Option<String>,
    /// What was done.
    pub counts: CountsEntry,
    /// What is left out, so that the file is no larger than it may be.
    pub left_out: LeftOutEntry,
    /// The members of a portfolio; none where there was one search. All else is of the one that answers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub members: Vec<MemberEntry>,
    /// What is wrong with a start or goal that is infeasible.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<FindingEntry>,
    /// The start, by coordinate of the path file; none where it is no configuration.
    pub start: Option<Vec<f64>>,
    /// Goals that are whole configurations, likewise.
    pub goals: Vec<Vec<f64>>,
    /// How goals that leave something free fared.
    pub goal_search: GoalSearchEntry,
    /// Roots of trees.
    pub roots: RootsEntry,
    /// States of the constraint graph.
    pub states: Vec<StateEntry>,
    /// Transitions of the constraint graph.
    pub transitions: Vec<TransitionEntry>,
    /// What became of the candidates, by transition; of all transitions that were tried.
    pub funnel: Vec<FunnelEntry>,
    /// Numbers of a configuration in the columns.
    pub width: usize,
    /// Where the coordinates stand that the columns do not have.
    pub still: Vec<f64>,
    /// How many nodes the columns have.
    pub nodes: u64,
    /// How many edges they have.
    pub edges: u64,
    /// How many configurations of collisions they have.
    pub collisions: u64,
    /// What was searched, as a path file: scene, models, coordinates, bounds, grippers, handles. Its segments are the path that was found;
    /// none where there is none.
    pub path: PathFile,
}

/// What a search did; none of it depends on clocks or threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CountsEntry {
    /// Steps, of all members.
    pub steps: u64,
    /// Candidates, of all members.
    pub candidates: u64,
    /// Candidates whose waypoints all projected, of all members.
    pub validated: u64,
    /// Nodes of the whole roadmap.
    pub nodes: u64,
    /// Certified edges of the whole roadmap.
    pub edges: u64,
    /// Leaves that were reached.
    pub leaves: u64,
    /// Trees that were ever born.
    pub trees: u64,
}

/// What a recording leaves out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeftOutEntry {
    /// Nodes; those that came last.
    pub nodes: u64,
    /// Edges, certified or not.
    pub edges: u64,
    /// States.
    pub states: u64,
    /// Transitions.
    pub transitions: u64,
    /// Rows of the funnel, with their transitions.
    pub funnel: u64,
    /// Pairs of the funnel; those that stopped the fewest candidates.
    pub pairs: u64,
    /// Configurations of pairs that are listed.
    pub collisions: u64,
    /// Whether the path was found and is left out.
    pub path: bool,
}

/// A member of a portfolio.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemberEntry {
    /// Name of its scheduler.
    pub scheduler: String,
    /// Whether the recording is of this one.
    pub answers: bool,
    /// Its steps.
    pub steps: u64,
    /// Its candidates.
    pub candidates: u64,
}

/// Something that is wrong with a start or goal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FindingEntry {
    /// `start` or `goal`.
    pub at: String,
    /// What, with its numbers.
    pub words: String,
    /// The shapes that collide, `part/shape`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shapes: Option<[String; 2]>,
    /// Their links, `part/link`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub links: Option<[String; 2]>,
    /// A number that is wrong: a coordinate, a residual, or how far apart two shapes are, negative where they overlap. SI units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// What would be allowed: the bound of the coordinate, the margin of the shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// The coordinate that it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordinate: Option<String>,
    /// The object that it is about, where the nearest state has an object elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misplaced: Option<MisplacedEntry>,
}

/// An object that no state has where it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MisplacedEntry {
    /// The name of its part.
    pub object: String,
    /// Where the nearest state has its root link: `[x, y, z, qx, qy, qz, qw]` in the world, metres.
    pub pose: [f64; 7],
    /// By which angle it would have to be turned, radians.
    pub angle: f64,
}

/// How goals that leave something free fared.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalSearchEntry {
    /// Configurations that were tried.
    pub tries: u64,
    /// Configurations that became goals.
    pub found: u64,
    /// Projections that did not converge.
    pub projection_failed: u64,
    /// Configurations outside of bounds, or in no state.
    pub refused: u64,
    /// Pairs that collided.
    pub pairs: Vec<BlockedPairEntry>,
}

/// The nodes that are roots of the trees of start and goals.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RootsEntry {
    /// Of the start.
    pub start: Option<u32>,
    /// Of the goals.
    pub goals: Vec<u32>,
}

/// A state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateEntry {
    /// Its number in the constraint graph.
    pub id: u32,
    /// As in path files.
    pub name: String,
    /// In plain words.
    pub words: String,
    /// Whether only legs of transitions lie in it.
    #[serde(default, skip_serializing_if = "is_false")]
    pub passed_through: bool,
    /// The constraints whose values tell its leaves.
    pub leaves_by: Vec<String>,
    /// Nodes in it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub nodes: u64,
    /// Leaves of it that were reached.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub leaves: u64,
    /// Candidates that started in it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub extended: u64,
    /// Motions between two trees that were tried in it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub connections_tried: u64,
    /// Those of them that joined two trees.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub connections_made: u64,
}

/// A transition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionEntry {
    /// Its number in the constraint graph.
    pub id: u32,
    /// As in path files.
    pub name: String,
    /// In plain words.
    pub words: String,
    /// Place of the state that it leaves.
    pub from: u32,
    /// Place of the state that it reaches.
    pub to: u32,
    /// `loop`, `regular` or `crossed`.
    pub kind: String,
    /// What it passes, in plain words.
    pub waypoints: Vec<String>,
}

/// What became of the candidates of a transition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FunnelEntry {
    /// Place of the transition.
    pub transition: u32,
    /// Candidates that chose it.
    pub tried: u64,
    /// Of these: all waypoints were found.
    pub projected: u64,
    /// Of these: no waypoint collides.
    pub free: u64,
    /// Of these: reached the target.
    pub reached: u64,
    /// Of these that did not: a part was kept.
    pub partial: u64,
    /// What stopped the others.
    pub rejections: Vec<RejectionEntry>,
    /// The pairs that stopped candidates, most frequent first.
    pub pairs: Vec<BlockedPairEntry>,
}

/// How many candidates were stopped for a reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RejectionEntry {
    /// In words.
    pub reason: String,
    /// Number of the leg, where it is about one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leg: Option<u8>,
    /// How many.
    pub count: u64,
}

/// A pair of shapes that collided.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockedPairEntry {
    /// The shapes, `part/shape`.
    pub shapes: [String; 2],
    /// Their links, `part/link`.
    pub links: [String; 2],
    /// How often.
    pub count: u64,
    /// Place of a configuration at which they were found closer than they may be, among those of collisions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<u32>,
}

fn is_false(flag: &bool) -> bool {
    !*flag
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}
