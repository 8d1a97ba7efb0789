//! Lists what a crate shows to other crates, from its sources: one line per item, field, variant, method and implemented trait.
//!
//! What macros make is not seen. `items` reads the files, `listing` walks the public modules and what they re-export.

mod items;
mod listing;

pub use listing::list;
