//! Compiled constraints: each writes its rows of the Newton problem.

use crate::constraints::centre_of_mass::MassColumns;
use crate::constraints::com_between::StanceColumns;
use crate::constraints::custom::{FunctionColumns, FunctionMemory};
use crate::constraints::placement::Contact;
use crate::constraints::rows_out::{RowsOut, reference_of};
use crate::constraints::{centre_of_mass, com_between, distance, locked, placement, relative_pose};
use crate::kinematics::forward::Placement as BodyFrame;
use crate::kinematics::jacobian::Column;
use foliate_components::Pose;
use foliate_components::constraint::{
    CentreOfMass, CentreOfMassBetween, Distance, LockedValue, Placement, Reference, Rows,
};
use glam::DVec3;

/// A compiled constraint.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Which of the given constraints it comes from: index among them, after the rigid attachments.
    pub source: usize,
    /// Its first row.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// What it says.
    pub kind: Kind,
}

#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Pose(PoseBlock),
    Contact(ContactBlock),
    Balance {
        balance: CentreOfMass,
        masses: MassColumns,
    },
    BalanceBetween {
        balance: CentreOfMassBetween,
        columns: Box<StanceColumns>,
    },
    Distance {
        distance: Distance,
        columns: Vec<Column>,
    },
    Custom(FunctionColumns),
    /// A locked joint that another constraint has locked already, or that is not free: always a check.
    Locked {
        coordinate: usize,
        value: LockedValue,
    },
}

#[derive(Clone, Debug)]
pub(crate) struct PoseBlock {
    pub a: BodyFrame,
    pub b: BodyFrame,
    pub rows: Rows,
    pub reference: Reference,
    pub columns: Vec<Column>,
}

#[derive(Clone, Debug)]
pub(crate) struct ContactBlock {
    pub placement: Placement,
    pub part: Part,
    /// For each support polygon, how variables move the object against it.
    pub columns: Vec<Vec<Column>>,
    /// Index of this block's decoded parameter in the scratch.
    pub decoded: usize,
}

/// Which rows of a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    Contact,
    Complement(usize),
    Hold(usize),
}

impl Part {
    pub(crate) fn slot(self) -> Option<usize> {
        match self {
            Self::Contact => None,
            Self::Complement(slot) | Self::Hold(slot) => Some(slot),
        }
    }

    pub(crate) fn dimension(self) -> usize {
        match self {
            Self::Contact => 5,
            Self::Complement(_) => 3,
            Self::Hold(_) => 6,
        }
    }
}

/// Where rows are evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inputs<'a> {
    pub q: &'a [f64],
    pub arguments: &'a [Pose],
    pub decoded: &'a [Decoded],
    pub X_WJ: &'a [Pose],
}

impl Block {
    /// All columns, whichever support, mass or frame they belong to.
    pub(crate) fn columns_mut(&mut self) -> Vec<&mut Column> {
        fn moments(masses: &mut MassColumns) -> impl Iterator<Item = &mut Column> {
            masses.columns.iter_mut().map(|moment| &mut moment.column)
        }
        match &mut self.kind {
            Kind::Pose(pose) => pose.columns.iter_mut().collect(),
            Kind::Contact(contact) => contact.columns.iter_mut().flatten().collect(),
            Kind::Balance { masses, .. } => moments(masses).collect(),
            Kind::BalanceBetween { columns, .. } => {
                moments(&mut columns.masses).chain(columns.feet.iter_mut().flatten()).collect()
            }
            Kind::Distance { columns, .. } => columns.iter_mut().collect(),
            Kind::Custom(function) => function.columns.iter_mut().flatten().collect(),
            Kind::Locked { .. } => Vec::new(),
        }
    }

    /// Whether any variable moves its rows.
    pub(crate) fn is_free(&mut self) -> bool {
        !self.columns_mut().is_empty()
    }

    /// How many of its rows come before those of rotations.
    pub(crate) fn translations(&self) -> usize {
        match &self.kind {
            Kind::Pose(pose) => pose.rows[..3].iter().flatten().count(),
            Kind::Contact(contact) if matches!(contact.part, Part::Complement(_)) => 2,
            Kind::Contact(_) => 3,
            _ => self.rows,
        }
    }

    /// How many moments it works with.
    pub(crate) fn moments(&self) -> usize {
        match &self.kind {
            Kind::Balance { masses, .. } => masses.moments(),
            Kind::BalanceBetween { columns, .. } => columns.masses.moments(),
            _ => 0,
        }
    }

    /// Writes values, and the Jacobian where it has room. Everything indexed has been checked when the program was
    /// compiled or the solve began.
    pub(crate) fn linearise(
        &self,
        at: Inputs<'_>,
        memory: &mut Memory,
        values: &mut [f64],
        jacobian: &mut [f64],
        stride: usize,
    ) {
        let Inputs { q, arguments, decoded, X_WJ } = at;
        let (first, end) = (self.first, self.first + self.rows);
        // Checks have no columns, and who asks for values alone brings no room for them.
        let is_asked = !jacobian.is_empty();
        let jacobian = jacobian.get_mut(first..).unwrap_or_default();
        let out = RowsOut { values: &mut values[first..end], jacobian, stride };
        match &self.kind {
            Kind::Pose(block) => {
                let reference = reference_of(block.reference, arguments);
                let columns = if is_asked { block.columns.as_slice() } else { &[] };
                relative_pose::linearise(&block.a, &block.b, &reference, &block.rows, columns, X_WJ, out);
            }
            Kind::Contact(block) => block.linearise(decoded, is_asked, X_WJ, out),
            Kind::Balance { balance, masses } => {
                let reference = reference_of(balance.reference, arguments);
                centre_of_mass::linearise(balance, &reference, masses, X_WJ, &mut memory.moments, out);
            }
            Kind::BalanceBetween { balance, columns } => {
                com_between::linearise(balance, columns, X_WJ, &mut memory.moments, out);
            }
            Kind::Distance { distance, columns } => {
                distance::linearise(distance, if is_asked { columns } else { &[] }, X_WJ, out);
            }
            Kind::Custom(function) => function.linearise(X_WJ, &mut memory.function, out),
            Kind::Locked { coordinate, value } => {
                out.values[0] = locked::value(q[*coordinate], locked_value(*value, arguments));
            }
        }
    }
}

impl ContactBlock {
    fn linearise(&self, decoded: &[Decoded], is_asked: bool, X_WJ: &[Pose], out: RowsOut<'_>) {
        let placement = &self.placement;
        let columns_on = |support: usize| if is_asked { self.columns[support].as_slice() } else { &[] };
        if self.part == Part::Contact {
            let contact = placement::contact(placement, X_WJ);
            placement::linearise(placement, contact, columns_on(contact.support), X_WJ, out);
            return;
        }
        let target = &decoded[self.decoded];
        let columns = columns_on(target.0.support);
        if matches!(self.part, Part::Complement(_)) {
            placement::linearise_complement(placement, target, columns, X_WJ, out);
        } else {
            placement::linearise_hold(placement, target, columns, X_WJ, out);
        }
    }
}

pub(crate) fn locked_value(value: LockedValue, arguments: &[Pose]) -> f64 {
    match value {
        LockedValue::Fixed(value) => value,
        LockedValue::Argument(slot) => arguments[slot].translation.x,
    }
}

/// A placement's leaf parameter, read.
pub(crate) type Decoded = (Contact, Pose);

/// What single constraints work with.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    pub(crate) moments: Vec<DVec3>,
    pub(crate) function: FunctionMemory,
}
