//! The common centre of some masses in a frame: fixed or frozen components, or half-spaces that bound it.

use crate::constraints::rows_out::{RowsOut, is_silent, placement_of, reference_of, silence};
use crate::kinematics::{AttachmentTree, MomentColumn, PointTree, WeightedPoint};
use foliate_components::Pose;
use foliate_components::constraint::{CentreOfMass, Masses, PlaneRow, Row};
use foliate_components::robot::JointIndex;
use glam::{DMat3, DVec3};

/// How free coordinates move a centre of mass as seen from a body.
#[derive(Clone, Debug)]
pub struct MassColumns {
    pub(crate) tree: PointTree,
    pub(crate) columns: Vec<MomentColumn>,
}

impl MassColumns {
    /// Reads the tree from the body `from` outwards; `variable` gives for a velocity coordinate its column, or `None`
    /// where it is not free, `moves` whether any coordinate of a joint is free.
    #[must_use]
    pub fn new(
        tree: &AttachmentTree,
        from: Option<JointIndex>,
        masses: &Masses,
        moves: impl Fn(JointIndex) -> bool,
        variable: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let points = PointTree::new(tree, from, weighted(masses), moves);
        Self { columns: points.columns(tree, variable), tree: points }
    }

    /// How many moments a linearisation works with.
    #[must_use]
    pub fn moments(&self) -> usize {
        self.tree.nodes().len()
    }
}

/// The masses as points whose weighted sum is their common centre.
pub(crate) fn weighted(masses: &Masses) -> impl Iterator<Item = WeightedPoint> + '_ {
    let total = masses.total();
    masses.bodies().iter().map(move |heavy| WeightedPoint {
        body: heavy.body,
        weight: heavy.mass / total,
        point: heavy.center,
    })
}

/// The common centre of the masses in the world, metres.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn centre(masses: &Masses, X_WJ: &[Pose]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for heavy in masses.bodies() {
        let center = heavy.body.map_or(heavy.center, |body| X_WJ[body.at()].transform_point(heavy.center));
        sum += heavy.mass * center;
    }
    sum / masses.total()
}

/// The centre in the constraint's frame, metres.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn in_frame(balance: &CentreOfMass, X_WJ: &[Pose]) -> DVec3 {
    placement_of(&balance.frame).in_world(X_WJ).inverse_transform_point(centre(&balance.masses, X_WJ))
}

/// What a row says of a centre in the frame: `normal · c − offset`, parameter rows measured from `reference`; metres.
#[must_use]
pub fn row(plane: &PlaneRow, center: DVec3, reference: DVec3) -> f64 {
    let from = if plane.row == Row::Parameter { center - reference } else { center };
    plane.normal.dot(from) - plane.offset
}

/// All rows, in order; metres.
///
/// # Panics
/// If a slice is too short.
pub fn value(balance: &CentreOfMass, arguments: &[Pose], X_WJ: &[Pose], values: &mut [f64]) {
    let (center, reference) = (in_frame(balance, X_WJ), reference_of(balance.reference, arguments).translation);
    values.iter_mut().zip(&balance.rows).for_each(|(value, plane)| *value = row(plane, center, reference));
}

/// The argument that makes parameter rows zero where the bodies are: the shortest such translation, so that what the
/// parameter rows do not use does not distinguish leaves.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn parameter(balance: &CentreOfMass, X_WJ: &[Pose]) -> Pose {
    let center = in_frame(balance, X_WJ);
    let mut axes: Vec<DVec3> = Vec::with_capacity(3);
    let mut sum = DVec3::ZERO;
    for plane in balance.rows.iter().filter(|plane| plane.row == Row::Parameter) {
        let across = axes.iter().fold(plane.normal, |left, &axis| left - axis * left.dot(axis));
        // Rows that repeat others add nothing.
        if across.length() > 1e-9 {
            let axis = across.normalize();
            let wanted = plane.normal.dot(center - sum) - plane.offset;
            sum += axis * (wanted / plane.normal.dot(axis));
            axes.push(axis);
        }
    }
    Pose::from_translation(sum)
}

/// Writes the rows and their Jacobian; `masses` are those of the constraint, seen from its frame's body, and `moments` is
/// working memory. A satisfied inequality has value and Jacobian zero.
///
/// # Panics
/// If a slice is too short.
pub fn linearise(
    balance: &CentreOfMass,
    reference: &Pose,
    masses: &MassColumns,
    X_WJ: &[Pose],
    moments: &mut [DVec3],
    out: RowsOut<'_>,
) {
    let RowsOut { values, jacobian, stride } = out;
    let X_WF = placement_of(&balance.frame).in_world(X_WJ);
    let center = X_WF.inverse_transform_point(masses.tree.moments(X_WJ, moments));
    for (value, plane) in values.iter_mut().zip(&balance.rows) {
        *value = row(plane, center, reference.translation);
    }
    let R_FW = DMat3::from_quat(X_WF.rotation.conjugate());
    let columns = if jacobian.is_empty() { &[] } else { masses.columns.as_slice() };
    for column in columns {
        let velocity = R_FW * column.velocity(X_WJ, moments);
        let numbers = &mut jacobian[column.column.variable() * stride..];
        for ((number, plane), value) in numbers.iter_mut().zip(&balance.rows).zip(values.iter()) {
            if !is_silent(plane.row, *value) {
                *number += plane.normal.dot(velocity);
            }
        }
    }
    silence(values, balance.rows.iter().map(|plane| plane.row));
}
