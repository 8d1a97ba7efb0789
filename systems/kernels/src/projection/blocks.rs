//! Compiled constraints: each writes its rows of the Newton problem.

use super::scratch::Decoded;
use crate::constraints::{RowsOut, locked, placement, reference_of, relative_pose};
use crate::kinematics::{Column, Placement as BodyFrame};
use foliate_components::Pose;
use foliate_components::constraint::{LockedValue, Placement, Reference, Rows};

/// A compiled constraint.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Which of the given constraints it comes from: index among them, after the carriages.
    pub source: usize,
    /// Its first row.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// What it says.
    pub kind: Kind,
}

#[derive(Clone, Debug)]
pub(super) enum Kind {
    Pose(PoseBlock),
    Contact(ContactBlock),
    /// A locked joint that another constraint has locked already, or that is not free: always a check.
    Locked {
        coordinate: usize,
        value: LockedValue,
    },
}

#[derive(Clone, Debug)]
pub(super) struct PoseBlock {
    pub a: BodyFrame,
    pub b: BodyFrame,
    pub rows: Rows,
    pub reference: Reference,
    pub columns: Vec<Column>,
}

#[derive(Clone, Debug)]
pub(super) struct ContactBlock {
    pub placement: Placement,
    pub part: Part,
    /// For each support polygon, how variables move the object against it.
    pub columns: Vec<Vec<Column>>,
    /// Index of this block's decoded parameter in the scratch.
    pub decoded: usize,
}

/// Which rows of a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Contact,
    Complement(usize),
    Hold(usize),
}

impl Part {
    pub(super) fn slot(self) -> Option<usize> {
        match self {
            Self::Contact => None,
            Self::Complement(slot) | Self::Hold(slot) => Some(slot),
        }
    }

    pub(super) fn dimension(self) -> usize {
        match self {
            Self::Contact => 5,
            Self::Complement(_) => 3,
            Self::Hold(_) => 6,
        }
    }
}

/// Where rows are evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs<'a> {
    pub q: &'a [f64],
    pub arguments: &'a [Pose],
    pub decoded: &'a [Decoded],
    pub X_WJ: &'a [Pose],
}

impl Block {
    /// All columns, whichever support they belong to.
    pub(super) fn columns_mut(&mut self) -> impl Iterator<Item = &mut Column> {
        let (one, many): (&mut [Column], &mut [Vec<Column>]) = match &mut self.kind {
            Kind::Pose(pose) => (&mut pose.columns, &mut []),
            Kind::Contact(contact) => (&mut [], &mut contact.columns),
            Kind::Locked { .. } => (&mut [], &mut []),
        };
        one.iter_mut().chain(many.iter_mut().flatten())
    }

    /// Whether any variable moves its rows.
    pub(super) fn is_free(&mut self) -> bool {
        self.columns_mut().next().is_some()
    }

    /// Writes values and Jacobian. Everything indexed has been checked when the program was compiled or the solve began.
    pub(super) fn linearise(&self, at: Inputs<'_>, values: &mut [f64], jacobian: &mut [f64], stride: usize) {
        let Inputs { q, arguments, decoded, X_WJ } = at;
        let (first, end) = (self.first, self.first + self.rows);
        // Checks have no columns.
        let jacobian = jacobian.get_mut(first..).unwrap_or_default();
        let out = RowsOut { values: &mut values[first..end], jacobian, stride };
        match &self.kind {
            Kind::Pose(block) => {
                let reference = reference_of(block.reference, arguments);
                relative_pose::linearise(&block.a, &block.b, &reference, &block.rows, &block.columns, X_WJ, out);
            }
            Kind::Contact(block) => block.linearise(decoded, X_WJ, out),
            Kind::Locked { coordinate, value } => {
                out.values[0] = locked::value(q[*coordinate], locked_value(*value, arguments));
            }
        }
    }
}

impl ContactBlock {
    fn linearise(&self, decoded: &[Decoded], X_WJ: &[Pose], out: RowsOut<'_>) {
        let placement = &self.placement;
        if self.part == Part::Contact {
            let contact = placement::contact(placement, X_WJ);
            placement::linearise(placement, contact, &self.columns[contact.support], X_WJ, out);
            return;
        }
        let target = &decoded[self.decoded];
        let columns = &self.columns[target.0.support];
        if matches!(self.part, Part::Complement(_)) {
            placement::linearise_complement(placement, target, columns, X_WJ, out);
        } else {
            placement::linearise_hold(placement, target, columns, X_WJ, out);
        }
    }
}

pub(super) fn locked_value(value: LockedValue, arguments: &[Pose]) -> f64 {
    match value {
        LockedValue::Fixed(value) => value,
        LockedValue::Argument(slot) => arguments[slot].translation.x,
    }
}
