//! Settings of certificates: guard, resolution, limits on samples, and how far rigid pairs may move.
//!
//! They are apart because the query of one pair, the certifier and the public verdicts all read them.

/// What to prove, and how hard to try.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertificateSettings {
    /// Added to every margin, so that independent checkers agree; metres.
    pub clearance_guard: f64,
    /// Where a pair can move by no more than this within an interval and still is not certified, it is taken to collide:
    /// in doubt, in collision. Metres.
    pub resolution: f64,
    /// How close to the truth the end of the valid prefix has to be, as a share of the motion.
    pub prefix_resolution: f64,
    /// Whether to stop at the first collision found, without looking for the valid prefix.
    pub all_or_nothing: bool,
    /// Whether the start is known to be free: pairs that do not move along this motion are then not tested.
    pub start_is_free: bool,
    /// Configurations that may be tested; a motion that needs more is free up to where it is certified by then.
    pub max_samples: u32,
    /// How far along the motion the relative pose of a rigid pair may leave that at its start: metres of the
    /// pair's origin, and radians. Infinite where nothing is known: rigid pairs then prove nothing.
    pub rigid_within: f64,
}

impl Default for CertificateSettings {
    fn default() -> Self {
        Self {
            clearance_guard: 1e-5,
            resolution: 1e-4,
            prefix_resolution: 4e-3,
            all_or_nothing: false,
            start_is_free: false,
            max_samples: 20_000,
            rigid_within: f64::INFINITY,
        }
    }
}
