//! Which file of a crate uses which: its sources, parsed.
//!
//! A page (a `mod.rs` or `lib.rs` that defines nothing itself) is transparent: a path through it leads to the file that
//! defines what it names. Code of tests is left out. Methods of types that are never named are not seen.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod circles;
mod sources;

pub use circles::circles;
pub use sources::Crate;
