//! What a search did.

use foliate::{FunnelRow, Report};
use pyo3::prelude::*;

/// What a search did. Times are of this run; everything else depends on problem, settings and seed alone.
#[pyclass(frozen, name = "Report", module = "foliate")]
pub struct PyReport {
    report: Report,
}

impl PyReport {
    pub(crate) fn of(report: &Report) -> Self {
        Self { report: report.clone() }
    }
}

#[pymethods]
impl PyReport {
    /// Steps.
    #[getter]
    fn steps(&self) -> u64 {
        self.report.steps
    }

    /// Candidates.
    #[getter]
    fn candidates(&self) -> u64 {
        self.report.candidates
    }

    /// Nodes of the roadmap.
    #[getter]
    fn nodes(&self) -> usize {
        self.report.nodes
    }

    /// Edges of the roadmap.
    #[getter]
    fn edges(&self) -> usize {
        self.report.edges
    }

    /// Leaves that were reached.
    #[getter]
    fn leaves(&self) -> usize {
        self.report.leaves
    }

    /// Seconds from the prepared problem to the answer, on the clock.
    #[getter]
    fn time(&self) -> f64 {
        self.report.time().as_secs_f64()
    }

    /// Hash of the roadmap: the same for any number of threads.
    #[getter]
    fn fingerprint(&self) -> u64 {
        self.report.fingerprint
    }

    /// What of the start and the goals was a little off a state and was moved onto it.
    #[getter]
    fn snapped(&self) -> Vec<String> {
        self.report.snapped.iter().map(ToString::to_string).collect()
    }

    /// What became of the candidates, a row for each transition.
    #[getter]
    fn funnel(&self) -> Vec<PyFunnelRow> {
        self.report.funnel.iter().map(PyFunnelRow::of).collect()
    }

    fn __repr__(&self) -> String {
        let Self { report } = self;
        format!(
            "Report(steps={}, candidates={}, nodes={}, leaves={}, time={:.4})",
            report.steps,
            report.candidates,
            report.nodes,
            report.leaves,
            report.time().as_secs_f64()
        )
    }
}

/// What became of the candidates of a transition.
#[pyclass(frozen, get_all, name = "FunnelRow", module = "foliate")]
pub struct PyFunnelRow {
    /// Name of the transition.
    transition: String,
    /// Candidates.
    tried: u64,
    /// Candidates that went a part of the way.
    partial: u64,
    /// Candidates that reached the target.
    reached: u64,
    /// How often the waypoints of a candidate could be projected, by Laplace's rule.
    projection_rate: f64,
    /// How often a candidate reached the target, by Laplace's rule.
    success_rate: f64,
    /// Pairs of shapes that stopped candidates, most frequent first, each with its count.
    blocked_by: Vec<(String, String, u64)>,
}

impl PyFunnelRow {
    fn of(row: &FunnelRow) -> Self {
        Self {
            transition: row.transition.clone(),
            tried: row.statistics.attempts,
            partial: row.statistics.partial,
            reached: row.statistics.reached,
            projection_rate: row.projection_rate,
            success_rate: row.success_rate,
            blocked_by: row.blocked_by.clone(),
        }
    }
}

#[pymethods]
impl PyFunnelRow {
    fn __repr__(&self) -> String {
        let Self { transition, tried, partial, reached, .. } = self;
        format!("FunnelRow({transition:?}, tried={tried}, partial={partial}, reached={reached})")
    }
}
