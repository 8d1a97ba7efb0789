//! `foliate models`: published robots. `install` lists and fetches them, `unpack` takes a package out of what was fetched.

pub(crate) mod install;
pub(crate) mod unpack;
