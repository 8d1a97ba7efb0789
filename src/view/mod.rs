//! Pages that show what is planned: a path as it is travelled, a scene before any search, a model; and pictures of constraint graphs.
//!
//! A page is one HTML file that opens from a disk: a [`Document`], arrays beside it ([`Blob`]), and the viewer's program. The page computes where links
//! are from the joints of the document, so that a frame is a configuration.
//!
//! `document` is the form of what a page carries, which `viewer/src` reads. `geometry` makes meshes small. `parts` writes the kinematic tree, `motion`
//! a path over time, `graph` the constraint graph with its layout; `pages` puts them together, and `html` writes the file.

pub(crate) mod document;
pub(crate) mod geometry;
pub(crate) mod graph;
pub(crate) mod html;
pub(crate) mod motion;
pub(crate) mod pages;
pub(crate) mod parts;

pub use crate::scene::visuals::{Visual, Visuals};
pub use crate::view::document::finding::{CollisionEntry, ViolationEntry, WhereEntry};
pub use crate::view::document::graph::{GraphEntry, MarkEntry, StateEntry, TransitionEntry, TransitionKindEntry};
pub use crate::view::document::model::{
    DocumentsEntry, FrameEntry, HandleEntry, JointEntry, LinkEntry, MeshEntry, PartEntry, PlacedShapeEntry, ShapeEntry,
    SurfaceEntry,
};
pub use crate::view::document::page::{Document, FORMAT, PageKind};
pub use crate::view::document::path::{ClearanceEntry, EventEntry, PathEntry, RefusalEntry, SegmentEntry};
pub use crate::view::document::search::{FunnelEntry, FunnelPairEntry, SearchEntry};
pub use crate::view::document::{Offset, PoseRow};
pub use crate::view::geometry::blob::Blob;
pub use crate::view::graph::grown::grown_graph;
pub use crate::view::graph::picture::{MOST_STATES, PictureOptions, picture};
pub use crate::view::graph::svg::svg;
pub use crate::view::html::page::Page;
pub use crate::view::pages::base::ViewOptions;
pub use crate::view::pages::of_model::page_of_model;
pub use crate::view::pages::of_path::{page_of_path, page_of_solution};
pub use crate::view::pages::of_recording::page_of_recording;
pub use crate::view::pages::of_scene::{model_of_scene, page_of_scene};
