//! What a motion moves in. `phases` holds the scene and who carries what from when on. `levers` bounds how fast two bodies
//! may approach each other, `limits` compares a motion with the limits of its joints, `report` is the form of the answer.

pub(crate) mod levers;
pub(crate) mod limits;
pub(crate) mod phases;
pub(crate) mod report;
