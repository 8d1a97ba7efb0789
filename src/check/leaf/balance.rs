//! Centres of mass, summed up afresh from the masses of the URDFs' links.

use crate::check::leaf::case::{Case, inequality, nearest, rows, value};
use crate::check::leaf::on_leaf::{Leaf, Named};
use crate::check::motion::reach::{Bends, Reach};
use crate::check::motion::residual::{Form, Quantity, prove};
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::shown;
use crate::check::report::error::CheckError;
use crate::check::world::documents::Frames;
use crate::check::world::models::Frame;
use crate::path_file::{ConstraintEntry, PlaneEntry};
use foliate_components::Pose;
use glam::{DVec3, Vec3Swizzles};

/// What is heavy: for each body its share of the mass, and the centre of that.
struct Heavy(Vec<(f64, Frame)>);

impl Heavy {
    /// The parts that a constraint names; without any the part of its frame.
    fn of(leaf: &Leaf<'_>, case: &Case<'_>) -> Result<Self, CheckError> {
        let entry = case.entry;
        let of_frame = entry.frame.as_ref().filter(|_| entry.parts.is_empty());
        let owner = of_frame.map(|f| f.parts().0.split('/').next().unwrap_or_default().to_owned());
        let world = leaf.motion.world;
        let mut bodies: Vec<(f64, Option<usize>, DVec3)> = Vec::new();
        for name in entry.parts.iter().chain(&owner) {
            let key = if owner.is_some() { "frame" } else { "parts" };
            let Some(part) = world.part(name) else {
                return case.refuse(key, format!("there is no part `{}`", shown(name)));
            };
            for (frame, mass) in &world.masses[part] {
                let moment = frame.body_from_frame.translation * *mass;
                match bodies.iter_mut().find(|(_, body, _)| *body == frame.body) {
                    Some((sum, _, moments)) => (*sum, *moments) = (*sum + mass, *moments + moment),
                    None => bodies.push((*mass, frame.body, moment)),
                }
            }
        }
        let total: f64 = bodies.iter().map(|(mass, ..)| mass).sum();
        let has_mass = total > 0.0 && total.is_finite() && bodies.iter().all(|(mass, ..)| *mass >= 0.0);
        if !has_mass {
            return case.refuse("parts", "have no mass, so no centre of mass");
        }
        let share = |(mass, body, moment): (f64, Option<usize>, DVec3)| {
            let center = Pose::from_translation(moment / mass);
            (mass / total, Frame { body, body_from_frame: center })
        };
        Ok(Self(bodies.into_iter().filter(|(mass, ..)| *mass > 0.0).map(share).collect()))
    }

    /// The centre in the world.
    fn centre(&self, motion: &SegmentMotion<'_>, at: At) -> DVec3 {
        self.0.iter().map(|(share, frame)| *share * motion.frame(frame, at).translation).sum()
    }

    /// A mean of points bends no more than the mean of their bounds.
    fn bends(&self, reach: &Reach, from: Option<usize>, knots: usize) -> Bends {
        let of = |frame: &Frame| reach.bends(from, (frame.body, frame.body_from_frame.translation.length()), knots);
        self.0.iter().fold(Bends::still(knots), |sum, (share, frame)| sum.plus(*share, &of(frame)))
    }
}

/// Where the first knot has the centre of mass that a constraint is about, in the constraint's frame.
pub(crate) fn first_centre(leaf: &Leaf<'_>, entry: &ConstraintEntry, frames: &Frames) -> Result<DVec3, CheckError> {
    let case = Case::new(entry, frames, "scene");
    let heavy = Heavy::of(leaf, &case)?;
    let to = case.frame(leaf, "to", entry.to.as_ref())?;
    let (motion, first) = (leaf.motion, At::knot(0));
    Ok(motion.frame(&to, first).inverse().transform_point(heavy.centre(motion, first)))
}

/// The centre of mass in a frame, as the origin of a frame that does not turn.
pub(crate) fn centre_of_mass(leaf: &mut Leaf<'_>, case: &Case<'_>) -> Result<(), CheckError> {
    let entry = case.entry;
    let heavy = Heavy::of(leaf, case)?;
    let to = case.frame(leaf, "to", entry.to.as_ref())?;
    let motion = leaf.motion;
    let centre =
        |at: At| Pose::from_translation(motion.frame(&to, at).inverse().transform_point(heavy.centre(motion, at)));
    let bends = heavy.bends(leaf.reach, to.body, motion.knots.len());
    let mask = entry.mask.unwrap_or_default();
    let mask = std::array::from_fn(|i| i < 3 && mask[i]);
    let back = value(entry).unwrap_or_else(|| centre(At::knot(0))).inverse();
    let from_value = |at: At| back * centre(at);
    leaf.prove_forms(&from_value, &bends, &case.relation(), &rows(mask, inequality(entry)));
    let planes: Vec<Named> = entry.planes.iter().map(plane).collect();
    leaf.prove_forms(&centre, &bends, &case.relation(), &planes);
    Ok(())
}

pub(crate) fn plane(entry: &PlaneEntry) -> Named {
    let normal = DVec3::from_array(entry.normal);
    if entry.inequality {
        return ("beyond a plane", Form::Outside { point: DVec3::ZERO, planes: vec![(-normal, -entry.offset)] });
    }
    ("off a plane", Form::Height { point: DVec3::ZERO, normal, offset: entry.offset })
}

/// Balance over the line between two feet.
pub(crate) fn between(leaf: &mut Leaf<'_>, case: &Case<'_>) -> Result<(), CheckError> {
    let entry = case.entry;
    let heavy = Heavy::of(leaf, case)?;
    let first = case.frame(leaf, "frame", entry.frame.as_ref())?;
    let second = case.frame(leaf, "to", entry.to.as_ref())?;
    let (motion, reach) = (leaf.motion, leaf.reach);
    let stance = |at: At| Stance {
        centre: heavy.centre(motion, at),
        first: motion.frame(&first, at).translation,
        second: motion.frame(&second, at).translation,
    };
    let knots = motion.knots.len();
    let foot = |f: &Frame| reach.bends(None, (f.body, f.body_from_frame.translation.length()), knots);
    let bends = [heavy.bends(reach, None, knots), foot(&first), foot(&second)];
    for (what, row) in [
        ("not at its height", Row::Height(entry.height)),
        ("beside the line between the feet", Row::Sideways),
        ("beyond the first foot", Row::Beyond { first: true }),
        ("beyond the second foot", Row::Beyond { first: false }),
    ] {
        if !matches!(row, Row::Height(None)) {
            let quantity = Balance { row, stance: &stance, bends: &bends };
            prove(motion, &quantity, what, &case.relation(), leaf.report, leaf.work);
        }
    }
    Ok(())
}

/// Where everything is in the world.
#[derive(Clone, Copy)]
struct Stance {
    centre: DVec3,
    first: DVec3,
    second: DVec3,
}

#[derive(Clone, Copy)]
enum Row {
    /// Over the middle of the feet, metres; free where none.
    Height(Option<f64>),
    /// The distance from the line, seen from above.
    Sideways,
    /// How far beyond a foot along the line.
    Beyond { first: bool },
}

struct Balance<'b> {
    row: Row,
    stance: &'b dyn Fn(At) -> Stance,
    /// Of the centre and both feet in the world.
    bends: &'b [Bends; 3],
}

impl Stance {
    /// From the foot that a row looks from to the centre, seen from above.
    fn arm(&self, row: Row) -> DVec3 {
        let foot = if matches!(row, Row::Beyond { first: false }) { self.second } else { self.first };
        flat(self.centre - foot)
    }

    fn line(&self) -> DVec3 {
        flat(self.second - self.first)
    }
}

fn flat(v: DVec3) -> DVec3 {
    v.xy().extend(0.0)
}

impl Quantity for Balance<'_> {
    type Sample = Stance;

    fn sample(&self, at: At) -> Stance {
        (self.stance)(at)
    }

    /// NaN where the feet stand on one point.
    fn error(&self, at: Stance) -> f64 {
        let along = at.line() / at.line().length();
        let arm = at.arm(self.row);
        match self.row {
            Row::Height(height) => {
                let above = at.centre.z - (at.first.z + at.second.z) / 2.0;
                height.map_or(0.0, |h| (above - h).abs())
            }
            Row::Sideways => along.cross(arm).z.abs(),
            // NaN stays one.
            Row::Beyond { first: true } => -along.dot(arm).min(0.0) + 0.0 * along.x,
            Row::Beyond { first: false } => along.dot(arm).max(0.0) + 0.0 * along.x,
        }
    }

    fn bound(&self, knot: usize, share: f64, [a, b]: [Stance; 2]) -> f64 {
        let [centre, first, second] = self.bends;
        let worst = self.error(a).max(self.error(b));
        let square = share * share / 8.0;
        if matches!(self.row, Row::Height(_)) {
            return worst + (centre.point[knot] + (first.point[knot] + second.point[knot]) / 2.0) * square;
        }
        let foot = if matches!(self.row, Row::Beyond { first: false }) { second } else { first };
        let (arm_bend, line_bend) = (centre.point[knot] + foot.point[knot], first.point[knot] + second.point[knot]);
        let (arm_speed, line_speed) = (centre.speed[knot] + foot.speed[knot], first.speed[knot] + second.speed[knot]);
        let arm = a.arm(self.row).length().max(b.arm(self.row).length()) + arm_bend * square;
        let line = nearest(a.line(), b.line()) - line_bend * square;
        if line <= 0.0 {
            return f64::INFINITY;
        }
        // The line's direction u = d/|d| has |u'| ≤ |d'|/|d| and |u''| ≤ |d''|/|d| + 2|d'|²/|d|²; a row is arm · u, or
        // across it.
        let turn = line_speed / line;
        let bend = arm_bend + 2.0 * arm_speed * turn + arm * (line_bend / line + 2.0 * turn * turn);
        worst + bend * square
    }

    fn travel(&self, knot: usize) -> f64 {
        self.bends.iter().map(|b| b.travel[knot]).fold(0.0, f64::max)
    }
}
