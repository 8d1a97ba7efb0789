//! The constraint graph of a page, laid out. y points down.

use serde::Serialize;

/// States and transitions with their places.
#[derive(Clone, Debug, Default, Serialize)]
pub struct GraphEntry {
    /// Width of the picture.
    pub width: f64,
    /// Its height.
    pub height: f64,
    /// What is not shown, in words; none where all of it is.
    pub left_out: Option<String>,
    /// States.
    pub states: Vec<StateEntry>,
    /// Transitions between them.
    pub transitions: Vec<TransitionEntry>,
    /// What is written beside lines (of small graphs), and waypoints.
    pub marks: Vec<MarkEntry>,
}

/// Words beside a line, or in the box of a waypoint.
#[derive(Clone, Debug, Serialize)]
pub struct MarkEntry {
    /// What is written.
    pub words: String,
    /// Their middle.
    pub x: f64,
    /// Likewise.
    pub y: f64,
    /// Width of the box; 0 where there is none.
    pub w: f64,
    /// Its height.
    pub h: f64,
}

/// A state.
#[derive(Clone, Debug, Serialize)]
pub struct StateEntry {
    /// Its number in the constraint graph.
    pub id: u32,
    /// As in path files.
    pub name: String,
    /// In plain words.
    pub words: String,
    /// Left edge of its box.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub w: f64,
    /// Height.
    pub h: f64,
    /// Whether only legs of transitions lie in it.
    pub passed_through: bool,
    /// What the box says, line by line.
    pub lines: Vec<String>,
}

/// How a transition chooses its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TransitionKindEntry {
    /// Stays in its state.
    Loop,
    /// Reaches whatever leaf of the target it leads to.
    Regular,
    /// Aims at a leaf that another tree has reached.
    Crossed,
}

/// A transition.
#[derive(Clone, Debug, Serialize)]
pub struct TransitionEntry {
    /// Its number in the constraint graph.
    pub id: u32,
    /// Place in the list of states of the one that it leaves.
    pub from: usize,
    /// Place of the one that it reaches.
    pub to: usize,
    /// As in path files.
    pub name: String,
    /// In plain words.
    pub words: String,
    /// How it chooses its target.
    pub kind: TransitionKindEntry,
    /// A polyline from box to box; the arrow is at its end.
    pub points: Vec<[f64; 2]>,
    /// How often a search tried it.
    pub tried: Option<u64>,
    /// How often it reached its target.
    pub succeeded: Option<u64>,
    /// What it passes, in order.
    pub waypoints: Vec<String>,
}
