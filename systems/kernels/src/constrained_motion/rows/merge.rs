//! A constraint and its complement say together more than apart: grasp and complement a rigid hold, contact and
//! complement a place on a support. Merged, they can eliminate an object.

use foliate_components::constraint::{Constraint, Reference, RelativePose, Row};

/// Merges each constraint with an earlier one that it complements. Every entry keeps the number of its first part.
pub(crate) fn merged(constraints: &[Constraint]) -> Vec<(usize, Constraint)> {
    let mut kept: Vec<(usize, Constraint)> = Vec::with_capacity(constraints.len());
    for (number, constraint) in constraints.iter().enumerate() {
        match kept.iter_mut().find_map(|(_, earlier)| Some((both(earlier, constraint)?, earlier))) {
            Some((together, earlier)) => *earlier = together,
            None => kept.push((number, constraint.clone())),
        }
    }
    kept
}

fn both(a: &Constraint, b: &Constraint) -> Option<Constraint> {
    match (a, b) {
        (Constraint::RelativePose(a), Constraint::RelativePose(b)) => {
            rigid(a, b).or_else(|| rigid(b, a)).map(Constraint::RelativePose)
        }
        (Constraint::Placement(contact), Constraint::PlacementComplement(placement, slot))
        | (Constraint::PlacementComplement(placement, slot), Constraint::Placement(contact))
            if contact == placement =>
        {
            Some(Constraint::PlacementHold(placement.clone(), *slot))
        }
        _ => None,
    }
}

/// `zero` with its rows at the identity, `parameter` with other rows of the same frames at an argument. A leaf parameter
/// is neutral in the rows that are zero, so the argument serves both.
fn rigid(zero: &RelativePose, parameter: &RelativePose) -> Option<RelativePose> {
    let only = |pose: &RelativePose, row: Row| pose.rows.iter().flatten().all(|&r| r == row);
    let apart = zero.rows.iter().zip(&parameter.rows).all(|(a, b)| a.is_none() || b.is_none());
    let same_frames = zero.a == parameter.a && zero.b == parameter.b;
    let kinds = only(zero, Row::Zero) && only(parameter, Row::Parameter) && parameter.dimension() > 0;
    let references = zero.reference == Reference::Identity && matches!(parameter.reference, Reference::Argument(_));
    if !(apart && same_frames && kinds && references) {
        return None;
    }
    let rows = std::array::from_fn(|i| zero.rows[i].or(parameter.rows[i]));
    Some(RelativePose { rows, ..*parameter })
}
