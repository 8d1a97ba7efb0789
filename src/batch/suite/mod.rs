//! A file that says what a batch is.
//!
//! `definition` is what it says, and the batch that makes; `read` reads it, and `read_vary` what varies.

pub(crate) mod definition;
pub(crate) mod read;
pub(crate) mod read_vary;
