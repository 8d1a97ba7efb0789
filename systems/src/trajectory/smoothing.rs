//! From a polyline to a path without corners: arcs in place of corners on leaves that straight lines stay on, splines through the
//! knots on leaves of implicit rows.

use crate::improvement::leaf_motion::LeafMotion;
use crate::planning_model::model::Model;
use crate::step::validation::certificate_settings;
use crate::trajectory::rounding::{Rounded, Rounding, is_given_up};
use crate::trajectory::smoothing_problem::{AT_WAYPOINT, SHARES, SmoothingProblem};
use foliate_components::Pose;
use foliate_kernels::collision::{CollisionScratch, CurveVerdict, certify_curve};
use foliate_kernels::constrained_motion::Scratch;
use foliate_kernels::curve::HermiteCurve;
use foliate_kernels::trajectory::{BlendError, Spline, ThroughScratch, blend_corner, blend_polyline, spline_through};

/// A smooth path from a stop to the next. Its parameter is seconds at full speed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SmoothPath {
    pub path: Spline,
    /// Where one motion ends and the next begins: parameters of the path, rising.
    pub joints: Vec<f64>,
}

/// A stretch that is not longer has no smooth path, in seconds at full speed.
const STILL: f64 = 1e-9;

/// Buffers of one thread.
#[derive(Debug, Default)]
pub(crate) struct SmoothingScratch {
    pub collision: CollisionScratch,
    solve: Scratch,
    through: ThroughScratch,
    arc: Spline,
}

impl SmoothingProblem<'_> {
    /// The stretch as smooth paths between stops: one, or more where a corner leaves no room for an arc; none where it hardly moves.
    ///
    /// # Errors
    /// Numbers that make no spline.
    pub(crate) fn paths(&self, scratch: &mut SmoothingScratch) -> Result<Vec<SmoothPath>, BlendError> {
        let last = self.knots() - 1;
        if last == 0 {
            return Ok(Vec::new());
        }
        if last == 1 && self.edge(0) <= STILL {
            return Ok(Vec::new());
        }
        if self.motions[self.stretch.motions.start].is_implicit {
            return self.through_knots(scratch);
        }
        let radii: Vec<f64> =
            (0..=last).map(|k| if k == 0 || k == last { 0.0 } else { self.radius(k, scratch) }).collect();
        let mut paths = Vec::new();
        let mut start = 0;
        while start < last {
            let (end, path) = self.path_from(start, &radii)?;
            paths.push(path);
            start = end;
        }
        Ok(paths)
    }

    /// Splines through the rounded knots of a leaf of implicit rows, and straight lines where splines were refused for good.
    fn through_knots(&self, scratch: &mut SmoothingScratch) -> Result<Vec<SmoothPath>, BlendError> {
        let last = self.knots() - 1;
        let is_straight = |edge: usize| [edge, edge + 1].iter().all(|&knot| is_given_up(self.refusals[knot]));
        let mut paths = Vec::new();
        let mut start = 0;
        while start < last {
            let end = match is_straight(start) {
                true => start + 1,
                false => (start..last).find(|&edge| is_straight(edge)).unwrap_or(last),
            };
            paths.push(self.through((start, end), scratch)?);
            start = end;
        }
        Ok(paths)
    }

    /// The spline between two stops of a leaf of implicit rows.
    fn through(&self, ends: (usize, usize), scratch: &mut SmoothingScratch) -> Result<SmoothPath, BlendError> {
        let (start, end) = ends;
        let rounded = match end - start {
            1 => None,
            _ => Rounding::between(self, ends).rounded(&mut scratch.solve),
        };
        let inside = self.stretch.joints.iter().filter(|joint| **joint > start && **joint < end);
        let rounded = rounded.unwrap_or_else(|| Rounded {
            knots: self.stretch.knots[start * self.size()..(end + 1) * self.size()].to_vec(),
            joints: inside.map(|&joint| joint - start).collect(),
        });
        let mut path = Spline::new(self.size());
        spline_through(&rounded.knots, &self.stretch.velocity, &mut scratch.through, &mut path)?;
        self.keep_bounds(&mut path);
        let mut joints: Vec<f64> = rounded.joints.iter().map(|&joint| path.parameters()[joint]).collect();
        // A motion that ends at the stop.
        let at_end = self.stretch.joints.iter().filter(|joint| **joint == end);
        joints.extend(at_end.map(|_| path.extent()));
        Ok(SmoothPath { path, joints })
    }

    /// Where a spline leaves the bounds of a coordinate between two knots, its derivatives there become those of a monotone piece
    /// (Fritsch and Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 1980): zero where the knot is an extreme, else
    /// at most three times the smaller slope.
    fn keep_bounds(&self, path: &mut Spline) {
        let space = &self.model.problem.robot.space;
        for i in (0..self.size()).filter(|&i| !self.stretch.carried[i]) {
            let leaves = |path: &Spline, piece: usize| {
                let [low, high] = path.position_range(piece, i);
                low < space.lower[i] || high > space.upper[i]
            };
            // What becomes monotone on one piece may leave the bounds on the next one. Derivatives only become smaller, so this ends.
            for _ in 0..path.len() {
                let pieces: Vec<usize> = (0..path.pieces()).filter(|&piece| leaves(path, piece)).collect();
                if pieces.is_empty() {
                    break;
                }
                for knot in pieces.iter().flat_map(|&piece| [piece, piece + 1]) {
                    let slope = |piece: usize| (path.knot(piece + 1)[i] - path.knot(piece)[i]) / path.width(piece);
                    let before = if knot == 0 { slope(0) } else { slope(knot - 1) };
                    let behind = if knot == path.pieces() { before } else { slope(knot) };
                    let most = if before * behind > 0.0 { 3.0 * before.abs().min(behind.abs()) } else { 0.0 };
                    let derivative = &mut path.velocity_mut(knot)[i];
                    *derivative = if before > 0.0 { derivative.clamp(0.0, most) } else { derivative.clamp(-most, 0.0) };
                }
            }
        }
    }

    /// The path from a knot to the next stop: the end of the stretch, or a corner without an arc.
    fn path_from(&self, start: usize, radii: &[f64]) -> Result<(usize, SmoothPath), BlendError> {
        let mut end = radii.len() - 1;
        let mut path = Spline::new(self.size());
        loop {
            let knots = &self.stretch.knots[start * self.size()..(end + 1) * self.size()];
            match blend_polyline(knots, &radii[start..=end], &self.stretch.velocity, &mut path) {
                Ok(()) => break,
                // The corner is where the robot stops.
                Err(BlendError::Corner { knot }) if knot > 0 => end = start + knot,
                Err(error) => return Err(error),
            }
        }
        let inside = |joint: &&usize| **joint > start && **joint <= end;
        let joints = self.stretch.joints.iter().filter(inside).map(|&joint| self.length(start, joint)).collect();
        Ok((end, SmoothPath { path, joints }))
    }

    /// Seconds at full speed from one knot to another. Arcs are as long as the corners that they replace.
    fn length(&self, from: usize, to: usize) -> f64 {
        (from..to).map(|k| self.edge(k)).sum()
    }

    /// The radius of the arc at a corner: the largest of some shares of its edges whose arc is free of collisions.
    fn radius(&self, k: usize, scratch: &mut SmoothingScratch) -> f64 {
        let is_waypoint = self.stretch.joints.contains(&k);
        let most = self.edge(k - 1).min(self.edge(k)) * if is_waypoint { AT_WAYPOINT } else { 1.0 };
        let shares = SHARES.get(self.refusals[k]..).unwrap_or_default();
        shares.iter().map(|share| share * most).find(|radius| self.is_free(k, *radius, scratch)).unwrap_or(0.0)
    }

    /// Whether the arc at a corner is free of collisions.
    fn is_free(&self, k: usize, radius: f64, scratch: &mut SmoothingScratch) -> bool {
        let corner = [self.knot(k - 1), self.knot(k), self.knot(k + 1)];
        scratch.arc.clear(self.size());
        if blend_corner(corner, radius, &self.stretch.velocity, &mut scratch.arc).is_err() {
            return false;
        }
        // At a joint each half is proved for both motions: they differ in their margins alone.
        let motions = self.stretch.motions.clone().map(|index| &self.motions[index]);
        let mut kinds: Vec<_> = motions.collect();
        kinds.dedup_by_key(|motion| motion.transition);
        kinds.into_iter().all(|motion| self.is_arc_free(motion, scratch))
    }

    fn is_arc_free(&self, motion: &LeafMotion, scratch: &mut SmoothingScratch) -> bool {
        let SmoothingScratch { collision, arc, .. } = scratch;
        let (model, settings) = (self.model, self.settings);
        let mut knots = Vec::with_capacity(2 * self.size());
        let mut velocities = Vec::with_capacity(2 * self.size());
        for knot in 0..arc.len() {
            knots.extend_from_slice(arc.knot(knot));
            velocities.extend_from_slice(arc.velocity(knot));
        }
        write_carried(model, motion, &self.stretch.carried, &mut knots, &mut velocities);
        let curve = HermiteCurve { knots: &knots, velocities: &velocities, times: arc.parameters() };
        let pairs = model.pairs(motion.transition, motion.state, &motion.rigid_attachments);
        let certificate = certificate_settings(settings, true);
        let verdict = certify_curve(
            &model.collision,
            &model.kinematics,
            &motion.rigid_attachments,
            &curve,
            pairs,
            &certificate,
            collision,
        );
        matches!(verdict, CurveVerdict::Free { .. })
    }
}

/// Writes objects where their carriers take them, at rest.
pub(crate) fn write_carried(
    model: &Model,
    motion: &LeafMotion,
    carried: &[bool],
    knots: &mut [f64],
    velocities: &mut [f64],
) {
    if !carried.contains(&true) {
        return;
    }
    let mut X_WJ = vec![Pose::identity(); model.kinematics.bodies()];
    for q in knots.chunks_exact_mut(carried.len()) {
        model.kinematics.forward(q, &mut X_WJ);
        model.kinematics.carry(q, &motion.rigid_attachments, &mut X_WJ);
        model.kinematics.write_back(&motion.rigid_attachments, &X_WJ, q);
    }
    for row in velocities.chunks_exact_mut(carried.len()) {
        row.iter_mut().zip(carried).filter(|(_, carried)| **carried).for_each(|(v, _)| *v = 0.0);
    }
}
