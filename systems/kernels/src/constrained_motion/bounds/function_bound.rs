//! How far rows of balance, of distances and of a host's functions can leave zero between two knots.
//!
//! As in `residual_bound`, a row leaves the straight line between its end values by at most ⅛ sup |f″|. A row that may not be
//! negative and starts farther from zero than it can come in the interval stays satisfied: it leaves nothing.

use crate::constrained_motion::bounds::joint_links::{Link, Pace};
use crate::constrained_motion::bounds::point_rates::{BoundMemory, PointRates, Rates};
use crate::constrained_motion::rows::blocks::{Block, Kind};
use crate::constraints::centre_of_mass::{self, weighted};
use crate::constraints::custom::FunctionColumns;
use crate::constraints::rows_out::placement_of;
use crate::kinematics::{AttachmentTree, WeightedPoint};
use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMass, Curvature, Distance, Frame, Masses, Row};
use foliate_components::robot::JointIndex;
use glam::DVec3;

/// ‖d²(d/|d|)/dt²‖ ≤ |d″|/|d| + `TURNING` |d′|²/|d|²: the largest of √(sin² 2φ + sin⁴ φ) over the angle φ from d to d′.
const TURNING: f64 = 1.154_700_538_379_252;

/// The bound on one block's rows.
#[derive(Clone, Debug)]
pub(crate) enum FunctionBound {
    Balance {
        balance: CentreOfMass,
        rates: PointRates,
    },
    /// From the first foot to the centre of mass, from there to the second foot, and from foot to foot.
    Between([PointRates; 3]),
    Distance {
        distance: Distance,
        rates: PointRates,
    },
    Function {
        function: FunctionColumns,
        frames: Vec<PointRates>,
    },
}

impl FunctionBound {
    /// `None` for constraints that have a bound of their own kind.
    pub(crate) fn new(tree: &AttachmentTree, block: &Block, links: impl Fn(JointIndex) -> Vec<Link>) -> Option<Self> {
        let rates = |from, points: Vec<WeightedPoint>| PointRates::new(tree, from, points, &links);
        let masses = |masses: &Masses, sign: f64| -> Vec<WeightedPoint> {
            weighted(masses).map(|heavy| WeightedPoint { weight: sign * heavy.weight, ..heavy }).collect()
        };
        let with = |mut points: Vec<WeightedPoint>, more: WeightedPoint| {
            points.push(more);
            points
        };
        Some(match &block.kind {
            Kind::Balance { balance, .. } => Self::Balance {
                rates: rates(balance.frame.joint, masses(&balance.masses, 1.0)),
                balance: balance.clone(),
            },
            Kind::BalanceBetween { balance, .. } => Self::Between([
                rates(None, with(masses(&balance.masses, 1.0), origin(&balance.first, -1.0))),
                rates(None, with(masses(&balance.masses, -1.0), origin(&balance.second, 1.0))),
                rates(None, vec![origin(&balance.first, -1.0), origin(&balance.second, 1.0)]),
            ]),
            Kind::Distance { distance, .. } => {
                Self::Distance { distance: *distance, rates: rates(distance.a.joint, vec![origin(&distance.b, 1.0)]) }
            }
            Kind::Custom(function) => Self::Function {
                frames: function.frames().iter().map(|frame| rates(None, vec![origin(frame, 1.0)])).collect(),
                function: function.clone(),
            },
            Kind::Pose(_) | Kind::Contact(_) | Kind::Locked { .. } => return None,
        })
    }

    /// At least what any row adds between the knots; infinite where nothing is known.
    pub(crate) fn bound(&self, pace: &Pace<'_>, start: &[Pose], memory: &mut BoundMemory) -> f64 {
        let mut of = |rates: &PointRates| rates.rates(pace, start, memory);
        let second = match self {
            Self::Balance { balance, rates } => of_balance(balance, &of(rates), start),
            Self::Between(rates) => of_stance(rates.each_ref().map(of)),
            Self::Distance { distance, rates } => of_distance(distance, &of(rates), start),
            Self::Function { function, frames } => of_function(function, frames, pace, start, memory),
        };
        // What is not a number bounds nothing.
        if second >= 0.0 { 0.125 * second } else { f64::INFINITY }
    }
}

fn origin(frame: &Frame, weight: f64) -> WeightedPoint {
    WeightedPoint { body: frame.joint, weight, point: frame.joint_from_frame.translation }
}

fn of_balance(balance: &CentreOfMass, rates: &Rates, start: &[Pose]) -> f64 {
    let center = placement_of(&balance.frame).in_world(start).inverse_transform_point(rates.start);
    let stays = |plane| centre_of_mass::row(plane, center, DVec3::ZERO) >= rates.speed;
    if balance.rows.iter().all(|plane| plane.row == Row::Inequality && stays(plane)) { 0.0 } else { rates.acceleration }
}

/// With u the direction from foot to foot, rows are e·u or e×u for a vector e: |(e·u)″| ≤ |e″| + 2|e′||u′| + |e||u″|, and
/// the height above the middle is half the difference of the vectors to and from the centre of mass.
fn of_stance([from_first, to_second, across]: [Rates; 3]) -> f64 {
    if [from_first, to_second, across].iter().all(|rates| rates.speed == 0.0) {
        return 0.0;
    }
    let nearest = across.start.truncate().length() - across.speed;
    if nearest <= 0.0 {
        return f64::INFINITY;
    }
    let turn = across.speed / nearest;
    let turning = across.acceleration / nearest + TURNING * turn * turn;
    let row = |e: Rates| {
        let longest = e.start.truncate().length() + e.speed;
        e.acceleration + 2.0 * e.speed * turn + longest * turning
    };
    row(from_first).max(row(to_second))
}

/// −|r″| ≤ |r|″ ≤ |r″| + |r′|²/|r|.
fn of_distance(distance: &Distance, rates: &Rates, start: &[Pose]) -> f64 {
    if rates.speed == 0.0 {
        return 0.0;
    }
    let length = placement_of(&distance.a).in_world(start).translation.distance(rates.start);
    let inside = if distance.at_most { distance.length - length } else { length - distance.length };
    let one_sided = distance.row == Row::Inequality;
    if one_sided && inside >= rates.speed {
        return 0.0;
    }
    if one_sided && distance.at_most {
        return rates.acceleration;
    }
    let nearest = length - rates.speed;
    if nearest <= 0.0 { f64::INFINITY } else { rates.acceleration + rates.speed * rates.speed / nearest }
}

fn of_function(
    function: &FunctionColumns,
    frames: &[PointRates],
    pace: &Pace<'_>,
    start: &[Pose],
    memory: &mut BoundMemory,
) -> f64 {
    let (mut speed, mut acceleration) = (0.0, 0.0);
    for frame in frames {
        let (point, (turn, turning)) = (frame.rates(pace, start, memory), frame.turning(pace));
        speed += point.speed + turn;
        acceleration += point.acceleration + turning;
    }
    match function.curvature() {
        _ if speed == 0.0 => 0.0,
        Some(Curvature { lipschitz, bend }) if lipschitz >= 0.0 && bend >= 0.0 => {
            if function.stays_satisfied(start, lipschitz * speed, &mut memory.function) {
                0.0
            } else {
                lipschitz * acceleration + bend * speed * speed
            }
        }
        _ => f64::INFINITY,
    }
}
