//! One page with plots of the rows of a batch, that opens from disk without a network.
//!
//! `groups` are the rows of one scene, scheduler and settings. `statistics` has the bands and quantiles, `canvas` the plane that plots are drawn
//! on. A plot a file: `solved` over time, `boxes` of times, `costs` over the time of improvement, `funnel` from the draws to the paths,
//! `scaling` with threads. `page` puts them together.

pub(crate) mod boxes;
pub(crate) mod canvas;
pub(crate) mod costs;
pub(crate) mod funnel;
pub(crate) mod groups;
pub(crate) mod page;
pub(crate) mod scaling;
pub(crate) mod solved;
pub(crate) mod statistics;

pub use crate::batch::report::page::{report_page, write_report};
