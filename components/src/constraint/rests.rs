//! The rules by which an object may lie on a support.

/// How an object must lie on its support. Margins are metres, in the plane of the support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rests {
    /// The centre of the object's polygon (the mean of its corners) is over the support's polygon: HPP's rule (P0 eq. 4).
    Centre,
    /// The object does not tip over: its centre of mass, projected along the support's normal, is inside both polygons by a margin.
    Stable {
        /// How far inside.
        margin: f64,
    },
    /// Nothing hangs over: the object's whole polygon is inside the support's by a margin.
    WholeFace {
        /// How far inside.
        margin: f64,
    },
}

/// What a problem means that does not say: objects do not tip over, by [`Rests::STABLE_MARGIN`].
impl Default for Rests {
    fn default() -> Self {
        Self::Stable { margin: Self::STABLE_MARGIN }
    }
}

impl Rests {
    /// How far inside both polygons the centre of mass is where a problem does not say, metres.
    pub const STABLE_MARGIN: f64 = 5e-3;

    /// How far inside the support's polygon the points must be, metres.
    #[must_use]
    pub fn margin(self) -> f64 {
        match self {
            Self::Centre => 0.0,
            Self::Stable { margin } | Self::WholeFace { margin } => margin,
        }
    }
}
