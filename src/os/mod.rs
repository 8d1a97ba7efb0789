//! What the operating system gives: memory and its limits (`memory`), files that are written whole or not at all (`output`).

pub mod memory;
#[cfg(feature = "scene")]
pub mod output;
