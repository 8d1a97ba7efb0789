//! The whole of a document.

use crate::view::document::finding::{CollisionEntry, ViolationEntry};
use crate::view::document::graph::GraphEntry;
use crate::view::document::model::{DocumentsEntry, JointEntry, LinkEntry, MeshEntry, PartEntry};
use crate::view::document::path::PathEntry;
use crate::view::document::search::SearchEntry;
use serde::Serialize;

/// The value of `format`.
pub const FORMAT: &str = "foliate.view/1";

/// Most pairs of links of a document; with more it has none.
pub const MOST_PAIRS: usize = 20_000;

/// What a page is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PageKind {
    /// A path.
    Path,
    /// A scene before any search.
    Scene,
    /// One model alone.
    Model,
    /// A search that was recorded.
    Search,
}

/// A page's document.
#[derive(Clone, Debug, Serialize)]
pub struct Document {
    /// [`FORMAT`].
    pub format: &'static str,
    /// What the page is called.
    pub title: String,
    /// What it is about.
    pub kind: PageKind,
    /// The seed, the scheduler and such: a label and what it says, in the order in which they are shown.
    pub facts: Vec<[String; 2]>,
    /// What could not be read or is left out.
    pub warnings: Vec<String>,
    /// How far a shown mesh is from the model's, metres, at most: of meshes with fewer triangles than their files have, measured from
    /// every vertex of the file. Rounding of positions is included.
    pub deviation: f64,
    /// Triangles of all meshes as their files have them, and as they are shown.
    pub triangles: [usize; 2],
    /// Meshes, each stored once.
    pub meshes: Vec<MeshEntry>,
    /// Robots, objects, environments.
    pub parts: Vec<PartEntry>,
    /// Links, fixed ones included.
    pub links: Vec<LinkEntry>,
    /// Joints that move, parents first.
    pub joints: Vec<JointEntry>,
    /// The names of the numbers of a configuration, as in path files.
    pub coordinates: Vec<String>,
    /// A configuration in which everything is shown that no other is given for.
    pub neutral: Vec<f64>,
    /// Grippers, handles, surfaces.
    pub documents: DocumentsEntry,
    /// The start.
    pub start: Option<Vec<f64>>,
    /// A goal, where one is a whole configuration, or where the path ends.
    pub goal: Option<Vec<f64>>,
    /// The constraint graph.
    pub graph: Option<GraphEntry>,
    /// The motion.
    pub path: Option<PathEntry>,
    /// Pairs of links that may not collide, of a model; none where there are more than 20 000.
    pub pairs: Option<Vec<[usize; 2]>>,
    /// Shapes that collide at a configuration.
    pub collisions: Vec<CollisionEntry>,
    /// What else is wrong with a configuration.
    pub violations: Vec<ViolationEntry>,
    /// What a search did.
    pub search: Option<SearchEntry>,
}
