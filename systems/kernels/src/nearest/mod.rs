//! Nearest configurations: a scan in lanes that leaves out what cannot be near, and the exact distance of the rest.
//!
//! A [`Bucket`] holds rounded coordinates in blocks `[dimension][lane]`. A scan finds, sixteen at a time, a lower bound of every
//! distance; the owner of the configurations ([`Seeker`]) then measures exactly those that may be nearer than what is known, so
//! that the answer is that of measuring all, bit for bit. At the sizes of roadmaps this beats trees. [`BucketQueries`] that ask
//! the same buckets share the reading of a block, and nothing else: each gets what it would get alone.

pub(crate) mod bucket;
pub(crate) mod metric;
pub(crate) mod queries;
pub(crate) mod scan;

pub use crate::nearest::bucket::{Bucket, nearest};
pub use crate::nearest::metric::Metric;
pub use crate::nearest::queries::{BucketQueries, Seeker};
