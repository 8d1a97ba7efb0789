//! Why a start or a goal cannot be planned for: typed reasons, and their words.

pub mod impossible_grasp;

pub use crate::infeasibility::impossible_grasp::{ImpossibleGrasp, ObjectPlace, RuledOut};

use crate::constraint::Rests;
use crate::infeasibility::impossible_grasp::tell_grasps;
use crate::problem::start_tolerance::{Correction, StartTolerance};
use crate::robot::indices::ShapeIndex;
use std::fmt;

/// Most pairs that a message names.
const MOST_PAIRS: usize = 60;
/// Most corrections that a message names.
const MOST_CORRECTIONS: usize = 8;
/// Closer than distances are exact, metres.
const TOUCHING: f64 = 1e-6;

/// Why a configuration cannot be a start or a goal, or why a goal has no configuration.
///
/// Coordinates are named as messages name them: `part/joint`, or `number 2 of part/root_joint` where a joint has several.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Infeasibility {
    /// The configuration has a wrong length.
    WrongLength {
        /// Its length.
        found: usize,
        /// The length that the robot needs.
        expected: usize,
    },
    /// A coordinate is infinite or not a number.
    NotFinite {
        /// Which.
        coordinate: String,
    },
    /// A coordinate is outside its bounds, metres or radians.
    OutOfBounds {
        /// Which.
        coordinate: String,
        /// Its value.
        value: f64,
        /// Lower and upper bound.
        bounds: (f64, f64),
        /// The reason why the bounds are smaller than the joint's own, where they are.
        narrowed: Option<Box<NarrowedBy>>,
    },
    /// A locked coordinate stands elsewhere, metres or radians.
    Locked {
        /// Which.
        coordinate: String,
        /// Its value.
        value: f64,
        /// Where it is locked.
        locked_at: f64,
    },
    /// The configuration lies in no state of the constraint graph.
    NoState {
        /// What keeps it out of the least demanding state; `None` where no state is allowed at all.
        nearest: Option<Box<NearestState>>,
        /// Whether the states were looked for one by one, in a lazy graph.
        lazy: bool,
    },
    /// Shapes collide.
    Collision(Vec<CollidingPair>),
    /// Fingers cannot move from where they are given to where their hand has them on its way, or back.
    FingersBlocked {
        /// The shapes that come too close, where that is known.
        by: Option<(String, String)>,
    },
    /// The problem has no goal.
    NoGoal,
    /// Every goal has an object elsewhere than the start, and no state that can be reached lets it move: a proof.
    ObjectNeverMoves {
        /// The object's name.
        object: String,
        /// How far the first goal has it from where it starts, metres.
        distance: f64,
        /// How far it is turned there, radians.
        angle: f64,
        /// Whether the problem has grippers at all.
        has_grippers: bool,
    },
    /// Every goal has an object elsewhere than the start, and each grasp of it is ruled out where it starts, or where the goals have
    /// it: a proof.
    NoGraspPossible {
        /// The object's name.
        object: String,
        /// Where the grasps are ruled out.
        place: ObjectPlace,
        /// All of its grasps, with what rules them out.
        grasps: Vec<ImpossibleGrasp>,
    },
    /// An object that starts in a hand stays in hands in every state that can be reached, and no goal wants it there: a proof.
    NeverPutDown {
        /// The object's name.
        object: String,
        /// The gripper that holds it in the start.
        gripper: String,
        /// Supports that are too small for it; without any no state is allowed in which it lies.
        too_small: Vec<String>,
    },
    /// No transitions lead from the state of the start to that of any goal: a proof.
    GoalStateApart {
        /// Name of the start's state.
        start: String,
        /// Name of the first goal's state.
        goal: String,
    },
    /// No goal has a configuration: one failure per goal that leaves something free.
    GoalsNotFound(Vec<GoalFailure>),
}

/// Joints that follow a joint by `<mimic>` and narrow its bounds by their own.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NarrowedBy {
    /// Names of the followers.
    pub followers: Vec<String>,
    /// The joint's own bounds, metres or radians.
    pub own: (f64, f64),
}

impl NarrowedBy {
    /// The followers and the leader's own bounds.
    #[must_use]
    pub fn new(followers: Vec<String>, own: (f64, f64)) -> Self {
        Self { followers, own }
    }
}

/// The constraint that keeps a configuration out of the state that is nearest to it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NearestState {
    /// Name of the state.
    pub state: String,
    /// Name of the constraint.
    pub constraint: String,
    /// Largest row of its error, metres and radians.
    pub residual: f64,
    /// Of a placement on surfaces: how far the object is off its support.
    pub off: Option<Box<OffSupport>>,
    /// What would have to be moved so that the configuration lies in the state, where that is known.
    pub corrections: Vec<Correction>,
    /// How far things are moved without asking.
    pub tolerance: StartTolerance,
}

/// How far an object is off the support that it is nearest to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OffSupport {
    /// Gap between the object's polygon and where it should be, over the support by the placement margin, metres; negative where it
    /// is too low.
    pub gap: f64,
    /// How far along the support it would have to go to lie on it as it must, metres; by the rule of centres to its middle.
    pub aside: f64,
    /// Angle between the polygons, radians.
    pub tilt: f64,
    /// By which rule it must lie.
    pub rests: Rests,
}

impl OffSupport {
    /// Gap and way along the support, metres, tilt, radians, and the rule by which it must lie.
    #[must_use]
    pub fn new(gap: f64, aside: f64, tilt: f64, rests: Rests) -> Self {
        Self { gap, aside, tilt, rests }
    }
}

impl fmt::Display for OffSupport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (side, millimetres) = if self.gap < 0.0 { ("below", -self.gap) } else { ("above", self.gap) };
        write!(
            f,
            "{:.2} mm {side} where it lies on its support, tilted by {:.2} mrad",
            millimetres * 1e3,
            self.tilt * 1e3
        )?;
        if self.aside > 0.0 {
            write!(f, ", and {:.2} mm beside where it may lie", self.aside * 1e3)?;
            match self.rests {
                Rests::Centre => {}
                Rests::Stable { .. } => write!(f, " without tipping over; rests = \"centre\" asks for less")?,
                Rests::WholeFace { .. } => write!(f, " with its whole face; rests = \"stable\" asks for less")?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for NearestState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { state, constraint, residual, off, corrections, tolerance } = self;
        for (number, correction) in corrections.iter().take(MOST_CORRECTIONS).enumerate() {
            f.write_str(if number == 0 { ". Nearest: " } else { "; " })?;
            f.write_str(&correction.to_words())?;
            if let Some(target) = correction.target() {
                write!(f, ", at {target}")?;
            }
        }
        match corrections.is_empty() {
            true => f.write_str(": ")?,
            false if tolerance.is_none() => f.write_str(". `start_tolerance` moves nothing: ")?,
            false => write!(f, ". `start_tolerance` moves at most {tolerance}: ")?,
        }
        write!(f, "`{constraint}` of state `{state}` is off by {residual:.3e}")?;
        off.as_ref().map_or(Ok(()), |off| write!(f, " (the object is {off})"))
    }
}

impl NearestState {
    /// A state, the constraint that does not hold, and by how much.
    #[must_use]
    pub fn new(state: String, constraint: String, residual: f64) -> Self {
        let (corrections, tolerance) = (Vec::new(), StartTolerance::default());
        Self { state, constraint, residual, off: None, corrections, tolerance }
    }
}

/// Two shapes that collide, or that are closer than their margin.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CollidingPair {
    /// The shapes.
    pub shapes: (ShapeIndex, ShapeIndex),
    /// Their names.
    pub names: (String, String),
    /// Names of their links.
    pub links: (String, String),
    /// Their distance, metres. Negative where they overlap: no shift shorter than this sets them apart. Minus infinity where one
    /// lies inside the other and nothing more is known; zero where they overlap and it is not known how deep (open meshes).
    pub distance: f64,
    /// The margin that they have to keep, metres.
    pub margin: f64,
}

impl CollidingPair {
    /// Two shapes (index, name, name of the link each), their distance and the margin that they have to keep, metres.
    #[must_use]
    pub fn new(
        first: (ShapeIndex, String, String),
        second: (ShapeIndex, String, String),
        distance: f64,
        margin: f64,
    ) -> Self {
        Self { shapes: (first.0, second.0), names: (first.1, second.1), links: (first.2, second.2), distance, margin }
    }
}

/// Why a goal that leaves something free has no configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct GoalFailure {
    /// Number of the goal in the problem, from 0.
    pub goal: usize,
    /// Why.
    pub kind: GoalFailureKind,
    /// What was tried, in words.
    pub message: String,
}

impl GoalFailure {
    /// The failure of goal number `goal`, from 0.
    #[must_use]
    pub fn new(goal: usize, kind: GoalFailureKind, message: String) -> Self {
        Self { goal, kind, message }
    }
}

/// Kinds of [`GoalFailure`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GoalFailureKind {
    /// The goal's own numbers are wrong: out of bounds, not finite, of an object that does not move.
    Malformed,
    /// The goal contradicts every state that was tried.
    ContradictsEveryState,
    /// No configuration was found within the budget of tries.
    NotFound {
        /// Tries.
        tries: u32,
    },
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongLength { found, expected } => write!(f, "it has {found} numbers instead of {expected}"),
            Self::NotFinite { coordinate } => write!(f, "{coordinate} is not finite"),
            Self::OutOfBounds { coordinate, value, bounds: (low, high), narrowed } => {
                write!(f, "{coordinate} = {value} is outside [{low}, {high}]")?;
                narrowed.as_ref().map_or(Ok(()), |narrowed| narrowed.fmt(f))
            }
            Self::Locked { coordinate, value, locked_at } => {
                write!(f, "{coordinate} = {value} is locked at {locked_at}")
            }
            Self::NoState { nearest: Some(nearest), .. } => {
                f.write_str("it lies in no state")?;
                nearest.fmt(f)
            }
            Self::NoState { nearest: None, lazy: true } => {
                f.write_str("it lies in no state: no state is allowed in which its grasps hold")
            }
            Self::NoState { nearest: None, lazy: false } => f.write_str("it lies in no state: no state is allowed"),
            Self::Collision(pairs) => tell_pairs(pairs, f),
            Self::FingersBlocked { by: Some((a, b)) } => {
                write!(f, "fingers cannot open or close there: {a} and {b} come too close")
            }
            Self::FingersBlocked { by: None } => {
                f.write_str("fingers are not where their hands have them, and the graph has no motion of them")
            }
            Self::NoGoal => f.write_str("the problem names no goal"),
            Self::ObjectNeverMoves { object, distance, angle, has_grippers } => {
                let (millimetres, degrees) = (distance * 1e3, angle.to_degrees());
                write!(
                    f,
                    "the goal has `{object}` {millimetres:.1} mm and {degrees:.1} degrees from where it starts, and "
                )?;
                f.write_str(match has_grippers {
                    true => "no gripper may hold it in any state that can be reached: it needs a handle, and a grasp that is allowed",
                    false => "nothing can hold it: no gripper is known. Grippers stand in the SRDF of the robot (`srdf = …` of its part)",
                })
            }
            Self::NoGraspPossible { object, place, grasps } => {
                write!(f, "`{object}` has to be moved, and no hand can hold it {}: ", place.words())?;
                tell_grasps(grasps, f)
            }
            Self::NeverPutDown { object, gripper, too_small } => tell_kept((object, gripper), too_small, f),
            Self::GoalStateApart { start, goal } => {
                write!(f, "no transitions lead from the state of the start, `{start}`, to that of the goal, `{goal}`")
            }
            Self::GoalsNotFound(failures) => {
                let messages: Vec<&str> = failures.iter().map(|failure| failure.message.as_str()).collect();
                f.write_str(&messages.join("; "))
            }
        }
    }
}

impl std::error::Error for Infeasibility {}

impl fmt::Display for NarrowedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = self.own;
        let followers = self.followers.join(", ");
        write!(f, ", where its followers keep their limits ({followers}); its own are [{low}, {high}]")
    }
}

impl fmt::Display for CollidingPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} and {} collide (", self.names.0, self.names.1)?;
        if self.distance == f64::NEG_INFINITY {
            f.write_str("one lies inside the other")?;
        } else if self.distance < -TOUCHING {
            write!(f, "{:.2} mm deep", -self.distance * 1e3)?;
        } else if self.distance <= TOUCHING {
            f.write_str("they touch or overlap")?;
        } else if self.margin > 0.0 {
            write!(f, "{:.2} mm apart instead of {:.2} mm", self.distance * 1e3, self.margin * 1e3)?;
        } else {
            write!(f, "{:.4} mm apart", self.distance * 1e3)?;
        }
        f.write_str(")")
    }
}

/// An object that no support takes from the gripper that holds it.
fn tell_kept((object, gripper): (&str, &str), too_small: &[String], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "`{object}` starts in {gripper}, the goal wants it out of every hand, and it can be put down nowhere: ")?;
    match too_small {
        [] => f.write_str("no state is allowed in which nothing holds it (`grasps`, `rules`)"),
        [one] => write!(f, "{one} is too small for it to lie on as `rests` asks"),
        all => write!(f, "{} are too small for it to lie on as `rests` asks", all.join(", ")),
    }
}

/// Every pair, and how to leave out those that may touch, in the words of a scene file.
fn tell_pairs(pairs: &[CollidingPair], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let shown: Vec<String> = pairs.iter().take(MOST_PAIRS).map(CollidingPair::to_string).collect();
    f.write_str(&shown.join("; "))?;
    if let Some(more) = pairs.len().checked_sub(MOST_PAIRS).filter(|&more| more > 0) {
        write!(f, "; and {more} pairs more")?;
    }
    let mut ignore: Vec<String> = Vec::new();
    for pair in pairs {
        let pair = format!("[\"{}\", \"{}\"]", pair.links.0, pair.links.1);
        if !ignore.contains(&pair) && ignore.len() < MOST_PAIRS {
            ignore.push(pair);
        }
    }
    write!(f, "; if they may touch, the scene can leave them out: ignore = [{}]", ignore.join(", "))
}
