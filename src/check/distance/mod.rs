//! TODO(page): what lies in check/distance.

pub(crate) mod apart;
pub(crate) mod convex;
pub(crate) mod measured;
pub(crate) mod pieces;
#[cfg(test)]
mod tests;
