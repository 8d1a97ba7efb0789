//! Distances of two shapes, by code of the checker's own: bounds that hold whatever found them (`apart`), over a tree of
//! boxes where there are many pieces (`pieces`, of the kinds in `convex`). `measured` puts them together. Nothing here is
//! shared with the search, which uses GJK and a hierarchy of its own; tests hold both against each other and against coal.

pub(crate) mod apart;
pub(crate) mod convex;
pub(crate) mod measured;
pub(crate) mod pieces;
#[cfg(test)]
mod tests;
