//! What a search has reached so far, beside the roadmap itself: resources that the commit writes and the other systems read.
//!
//! `roots` are where trees begin, `edges` the proposed connections and the edges that are not certified yet.
//! `reached_leaves` keeps the leaves of each tree, with `visited_leaves` and `parameter_column` below it; `explored` gives
//! systems one view of all that. `neighbours` finds nearest nodes. `writer` adds nodes, leaves and edges to roadmap, indices
//! and `entities` together. `memory` counts what all of it takes. `search_log` keeps what a recording tells beside all that.

pub mod edges;
pub mod entities;
pub mod explored;
pub mod memory;
pub mod neighbours;
pub mod parameter_column;
pub mod reached_leaves;
pub mod roadmap_query;
pub mod roots;
pub mod search_log;
pub(crate) mod visited_leaves;
pub mod writer;
