//! What a search has reached: nodes, edges, motions, and which of them are joined.
//!
//! The entities of nodes, edges and leaves are the source. `node`, `edge` and `leaf` define their components, `ids` the dense
//! ids of their rows, `entity_bytes` what an entity costs. `store` holds the numbers of configurations and motions, and what is derived from the components: the
//! edges at a node and the trees that are joined. [`Roadmap`] in `view` reads all of them together.
//!
//! Only `foliate_systems::exploration::writer` writes here.

pub mod edge;
mod entity_bytes;
pub mod ids;
pub mod leaf;
pub mod node;
pub mod store;
pub mod view;

pub use crate::roadmap::edge::{Motion, RoadmapEdge, UnvalidatedEdge};
pub use crate::roadmap::ids::{EdgeId, NodeId, TreeId};
pub use crate::roadmap::leaf::RoadmapLeaf;
pub use crate::roadmap::node::RoadmapNode;
pub use crate::roadmap::store::RoadmapStore;
pub use crate::roadmap::view::Roadmap;
