//! What coordinates do between knots (`curve`), where things are along a segment (`segment`), how far they can move on the way (`reach`), and bounds of relative poses
//! over the continuum (`residual`).

pub(crate) mod curve;
pub(crate) mod reach;
pub(crate) mod residual;
pub(crate) mod segment;
