//! Pages of paths, scenes and models. `base` is what every page has, `of_path`, `of_scene` and `of_model` add what
//! each shows; `findings` is what is wrong at a configuration.

pub(crate) mod base;
pub(crate) mod findings;
pub(crate) mod of_model;
pub(crate) mod of_path;
pub(crate) mod of_scene;
