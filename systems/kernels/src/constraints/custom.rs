//! A host's own function of the poses of some frames.

use crate::constraints::rows_out::{RowsOut, is_silent, placement_of, silence};
use crate::kinematics::Column;
use foliate_components::Pose;
use foliate_components::constraint::{Curvature, Custom, Frame, Gradient, Row};

/// Working memory for one evaluation.
#[derive(Clone, Debug, Default)]
pub struct FunctionMemory {
    X_WF: Vec<Pose>,
    values: Vec<f64>,
    gradients: Vec<Gradient>,
}

/// The rows where the bodies are.
///
/// # Panics
/// If `X_WJ` is too short.
#[must_use]
pub fn value(own: &Custom, X_WJ: &[Pose]) -> Vec<f64> {
    let X_WF: Vec<Pose> = own.0.frames().iter().map(|frame| placement_of(frame).in_world(X_WJ)).collect();
    let mut values = vec![0.0; own.0.rows().len()];
    own.0.value(&X_WF, &mut values);
    values
}

/// A function with what it says of itself read once, and how free coordinates move its frames.
#[derive(Clone, Debug)]
pub struct FunctionColumns {
    own: Custom,
    frames: Vec<Frame>,
    rows: Vec<Row>,
    /// For each frame those of its body against the world.
    pub columns: Vec<Vec<Column>>,
}

impl FunctionColumns {
    /// Reads the function; `columns` gives those of a frame's body against the world.
    #[must_use]
    pub fn new(own: &Custom, columns: impl FnMut(&Frame) -> Vec<Column>) -> Self {
        let frames = own.0.frames().to_vec();
        Self { columns: frames.iter().map(columns).collect(), frames, rows: own.0.rows().to_vec(), own: own.clone() }
    }

    /// The frames that the function depends on.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The function's rows.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The function's bounds on how it bends.
    #[must_use]
    pub fn curvature(&self) -> Option<Curvature> {
        self.own.0.curvature()
    }

    /// Whether all rows are inequalities that stay satisfied while none changes by more than `change`.
    ///
    /// # Panics
    /// If `X_WJ` is too short.
    #[must_use]
    pub fn stays_satisfied(&self, X_WJ: &[Pose], change: f64, memory: &mut FunctionMemory) -> bool {
        self.rows.iter().all(|&row| row == Row::Inequality) && {
            self.go_to(X_WJ, memory);
            memory.values.clear();
            memory.values.resize(self.rows.len(), 0.0);
            self.own.0.value(&memory.X_WF, &mut memory.values);
            memory.values.iter().all(|&value| value >= change)
        }
    }

    /// Poses of the frames.
    fn go_to(&self, X_WJ: &[Pose], memory: &mut FunctionMemory) {
        memory.X_WF.clear();
        memory.X_WF.extend(self.frames.iter().map(|frame| placement_of(frame).in_world(X_WJ)));
    }

    /// Writes the rows and their Jacobian. A satisfied inequality has value and Jacobian zero.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn linearise(&self, X_WJ: &[Pose], memory: &mut FunctionMemory, out: RowsOut<'_>) {
        let RowsOut { values, jacobian, stride } = out;
        let frames = self.frames.len();
        self.go_to(X_WJ, memory);
        self.own.0.value(&memory.X_WF, values);
        if jacobian.is_empty() {
            return silence(values, self.rows.iter().copied());
        }
        if self.columns.iter().any(|columns| !columns.is_empty()) {
            memory.gradients.clear();
            memory.gradients.resize(self.rows.len() * frames, Gradient::default());
            self.own.0.gradient(&memory.X_WF, &mut memory.gradients);
        }
        for (frame, (columns, X_WF)) in self.columns.iter().zip(&memory.X_WF).enumerate() {
            for column in columns {
                let (linear, angular) = column.twist(X_WJ, X_WF.translation);
                let numbers = &mut jacobian[column.variable() * stride..];
                for (r, (number, &row)) in numbers.iter_mut().zip(&self.rows).enumerate() {
                    if !is_silent(row, values[r]) {
                        let gradient = &memory.gradients[r * frames + frame];
                        *number += gradient.linear.dot(linear) + gradient.angular.dot(angular);
                    }
                }
            }
        }
        silence(values, self.rows.iter().copied());
    }
}
