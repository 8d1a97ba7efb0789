//! The text of a scene: what was found, as entries that a person may edit (`scene_text`), and numbers as they are written (`numbers`).

pub(crate) mod numbers;
pub(crate) mod scene_text;
