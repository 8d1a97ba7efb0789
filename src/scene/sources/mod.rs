//! Where the files of a scene are: the search for packages, and the files that names lead to.
//!
//! `package` resolves `package://` URLs, `program_files` are models in the program, `source` opens what a name means. `follower_limits` opens a model's URDF again to
//! name the lines of joints whose followers leave them no room.

pub(crate) mod follower_limits;
pub(crate) mod package;
pub(crate) mod program_files;
pub(crate) mod source;
