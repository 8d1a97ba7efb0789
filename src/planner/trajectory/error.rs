//! Why a path answers no question about time.

/// Why there is no trajectory, or no answer to a question about one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The path says where to go and not when.
    NoTimes,
    /// The path has no segments.
    Empty,
    /// Its numbers make no motion.
    Malformed {
        /// Number of the segment, from 0.
        segment: usize,
        /// What is wrong there.
        message: &'static str,
    },
    /// There is nothing of that name.
    Unknown {
        /// What was looked for: `joint`, `robot`, `link or part`.
        what: &'static str,
        /// The name.
        name: String,
        /// What there is, or how to say which one is meant.
        hint: String,
    },
    /// No rate, or one that asks for more samples than are made.
    Rate(f64),
}

impl std::fmt::Display for TrajectoryError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoTimes => f.write_str("the path has no times: it says where to go and not when"),
            Self::Empty => f.write_str("the path has no segments"),
            Self::Malformed { segment, message } => write!(f, "segment {segment}: {message}"),
            Self::Unknown { what, name, hint } => {
                write!(f, "there is no {what} `{}`: {hint}", name.escape_debug())
            }
            Self::Rate(rate) => {
                write!(f, "{rate} Hz is no rate for this path: it is above 0 and gives at most ten million samples")
            }
        }
    }
}

impl std::error::Error for TrajectoryError {}

impl TrajectoryError {
    /// That nothing has a name, with the names that there are.
    pub(crate) fn unknown<'a>(what: &'static str, name: &str, known: impl Iterator<Item = &'a str>) -> Self {
        const SHOWN: usize = 12;
        let known: Vec<&str> = known.take(SHOWN + 1).collect();
        let more = if known.len() > SHOWN { ", …" } else { "" };
        let hint = match known.as_slice() {
            [] => String::from("there are none"),
            known => format!("there are {}{more}", known[..known.len().min(SHOWN)].join(", ")),
        };
        Self::Unknown { what, name: name.to_owned(), hint }
    }
}
