//! What is wrong at a configuration.

use serde::Serialize;

/// Which configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum WhereEntry {
    /// `start` or `goal`: the document's.
    Named(&'static str),
    /// Its numbers.
    Numbers(Vec<f64>),
}

/// Two links collide.
#[derive(Clone, Debug, Serialize)]
pub struct CollisionEntry {
    /// Where.
    pub configuration: WhereEntry,
    /// The links.
    pub links: [usize; 2],
    /// No shift shorter than this sets them apart, metres; none where it is not known.
    pub depth: Option<f64>,
    /// Their distance where it is less than their margin, metres.
    pub distance: Option<f64>,
    /// A point in the world that both contain, or between them.
    pub point: Option<[f64; 3]>,
    /// The nearest points of the two in the world, where they are apart and too close.
    pub points: Option<[[f64; 3]; 2]>,
    /// In plain words, with the number.
    pub words: String,
}

/// A configuration breaks something else: a bound, a lock, a constraint.
#[derive(Clone, Debug, Serialize)]
pub struct ViolationEntry {
    /// Where.
    pub configuration: WhereEntry,
    /// In plain words, with the numbers.
    pub words: String,
    /// The number that is wrong, SI units.
    pub value: Option<f64>,
    /// What would be allowed.
    pub limit: Option<f64>,
    /// Number of the joint that it is about.
    pub joint: Option<usize>,
    /// The links that it is about.
    pub links: Option<Vec<usize>>,
    /// Of an object that lies in no state: the origin of its root link, and where the nearest state has this; in the world.
    pub points: Option<[[f64; 3]; 2]>,
    /// By which angle the object would have to be turned besides, radians.
    pub angle: Option<f64>,
}
