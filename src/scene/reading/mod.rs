//! What every reader of the scene shares: errors with a place, caps, and strict access to TOML and XML.
//!
//! `error` is the one error; `input` opens files and `limits` bounds the work; `keys` reads TOML and `xml` reads XML, both
//! with line numbers. `known` tells what a file says and no reader knows, `prefixes` declares those of XML that a file does not.
//! `cache_folders` names the user's cache directories.

pub(crate) mod cache_folders;
pub(crate) mod error;
pub(crate) mod input;
pub(crate) mod keys;
pub(crate) mod known;
pub(crate) mod limits;
pub(crate) mod prefixes;
pub(crate) mod xml;
