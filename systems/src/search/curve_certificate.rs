//! Proves a path with times as the curve that it is.

use crate::planning_model::model::Model;
use crate::settings::SearchSettings;
use foliate_components::path::{Certificate, ManipulationPath};
use std::fmt;

/// Where a curve is not proved.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveRefusal {
    /// Number of the segment, from 0.
    pub segment: usize,
    /// Number of the piece in it.
    pub piece: usize,
    /// What is not proved.
    pub what: String,
}

impl fmt::Display for CurveRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

/// Proves a path with times.
///
/// # Errors
/// The first segment that is not proved.
pub fn certify_path(
    model: &Model,
    settings: &SearchSettings,
    path: &ManipulationPath,
) -> Result<Certificate, CurveRefusal> {
    use crate::improvement::leaf_motion::LeafMotion;
    use crate::step::validation::certificate_settings;
    use foliate_kernels::collision::{CollisionScratch, CurveVerdict, certify_curve};
    use foliate_kernels::curve::HermiteCurve;
    let mut scratch = CollisionScratch::at_level(settings.level);
    for (number, segment) in path.segments.iter().enumerate() {
        let motion = LeafMotion::of_segment(model, segment).ok_or_else(|| CurveRefusal {
            segment: number,
            piece: 0,
            what: "no leaf".into(),
        })?;
        let Some(timing) = &segment.timing else { continue };
        let (knots, velocities) = (segment.knots.concat(), timing.velocities.concat());
        let curve = HermiteCurve { knots: &knots, velocities: &velocities, times: &timing.times };
        let pairs = model.pairs(motion.transition, motion.state, &motion.rigid_attachments);
        let verdict = certify_curve(
            &model.collision,
            &model.kinematics,
            &motion.rigid_attachments,
            &curve,
            pairs,
            &certificate_settings(settings, true),
            &mut scratch,
        );
        if let CurveVerdict::Blocked { piece, u, blocked_by } = verdict {
            let pair = blocked_by.map(|contact| model.pair_name(contact.pair)).unwrap_or_default();
            return Err(CurveRefusal {
                segment: number,
                piece,
                what: format!("piece {piece} at {u}: {pair} {blocked_by:?}"),
            });
        }
    }
    Ok(path.certificate)
}
