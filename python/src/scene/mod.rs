//! What is planned for: a scene (`py_scene`), read from a file, made of a `document`, or of models (`new_scene`); each `solid` of its links; `variations` of it.

pub(crate) mod document;
pub(crate) mod new_scene;
pub(crate) mod py_scene;
pub(crate) mod solid;
pub(crate) mod variations;
