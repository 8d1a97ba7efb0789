//! The world of a path file, rebuilt from what it names: bodies and shapes (`models`), then the frames of grippers, handles
//! and surfaces on them (`documents`), then what objects are attached to in each segment (`attachments`). `followers`
//! has the joints that follow others, `faces` tells faces that documents cut into pieces.

pub(crate) mod attachments;
pub(crate) mod documents;
pub(crate) mod faces;
pub(crate) mod followers;
pub(crate) mod models;
