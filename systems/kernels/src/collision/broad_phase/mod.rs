//! Broad phase: bounds of sixteen samples at once, which prove pairs free over their intervals without exact queries.
//!
//! Everything is computed in single precision from poses in double precision that were rounded once, in the order balls of
//! bodies, balls of shapes, boxes and capsules of shapes. A bound counts where it is at least what is needed plus the slack of
//! `placed`: centres, axes and sizes carry a few units of rounding each of the largest coordinate M that takes part (three
//! products and sums for a centre: 5 u M with u = 2⁻²⁴, two of them and their difference 12 u M, a frame's axes turned back on
//! it 8 u M, supports 8 u M); 64 u M covers them twice over. A segment's parameters may be off by any amount: what counts is
//! the gap along the direction that they give, which is a bound whatever the direction is.
//!
//! `placed` places clusters, joint axes and solids of a block in lanes, and bounds how far each group can approach. `bounds`
//! holds the distance bounds of placed solids. `block_of_samples` builds on both: it tests the open pairs of a block.
//! `along` builds on both as well: it tests one known separating direction in the other lanes of the block. `open_pairs` holds
//! the results that both return.

pub(crate) mod along;
pub(crate) mod block_of_samples;
pub(crate) mod bounds;
pub(crate) mod open_pairs;
pub(crate) mod placed;
