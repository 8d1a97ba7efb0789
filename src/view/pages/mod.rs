//! Pages of paths, scenes, models and recorded searches. `base` is what every page has, `of_path`, `of_scene`, `of_model` and
//! `of_recording` add what each shows; `findings` is what is wrong at a configuration.

pub(crate) mod base;
pub(crate) mod findings;
pub(crate) mod of_model;
pub(crate) mod of_path;
pub(crate) mod of_recording;
pub(crate) mod of_scene;
