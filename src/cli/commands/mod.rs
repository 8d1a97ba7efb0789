//! The commands, one file or folder each. Those that search share the options of `solve`, others its report of pairs; no command calls
//! `command_line`.

pub(crate) mod bench;
pub(crate) mod certify;
pub(crate) mod check;
pub(crate) mod demo;
pub(crate) mod export;
pub(crate) mod graph;
pub(crate) mod inspect;
pub(crate) mod models;
pub(crate) mod new;
pub(crate) mod scenes;
pub(crate) mod solve;
pub(crate) mod view;
