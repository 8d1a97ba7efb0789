//! Grasps of any surface: two points that face each other, close enough together for the jaws.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::FoundGripper;
use crate::setup::handles::handle::{FoundHandle, HandleSettings, Jaws, can_take, farther_out, frame};
use crate::setup::objects::RigidObject;
use crate::setup::solids::surface_points::{SurfacePoint, random, ray};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Directions of approach about each closing line.
const APPROACHES: usize = 12;
/// Grasps that are alike: their middles nearer than this (metres), and their axes nearer than this (radians).
const ALIKE: (f64, f64) = (0.015, 0.5);
/// Most candidates that are tested against the hand.
const TESTED: usize = 1500;

/// A grasp that may do.
struct Candidate {
    handle: FoundHandle,
    approach: DVec3,
    closing: DVec3,
    /// Smaller is better.
    cost: f64,
}

/// Antipodal grasps, the best first, thinned to those that differ.
pub(super) fn grasps(object: &RigidObject, gripper: &FoundGripper, settings: HandleSettings) -> Vec<FoundHandle> {
    let Some(jaws) = Jaws::of(gripper.kind) else { return Vec::new() };
    let points = random(&object.triangles, settings.samples, settings.seed);
    let mut candidates: Vec<Candidate> =
        points.iter().flat_map(|point| about(object, point, &jaws, settings.friction)).collect();
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<Candidate> = Vec::new();
    let mut tested = 0;
    for mut candidate in candidates {
        if kept.len() >= settings.most || tested >= TESTED {
            break;
        }
        let is_new = kept.iter().all(|other| {
            let apart =
                (other.handle.link_from_handle.translation).distance(candidate.handle.link_from_handle.translation);
            apart > ALIKE.0
                || other.approach.angle_between(candidate.approach) > ALIKE.1
                || other.closing.angle_between(candidate.closing) > ALIKE.1
        });
        if !is_new {
            continue;
        }
        tested += 1;
        let fits = can_take(object, gripper, &candidate.handle);
        let moved = if fits { None } else { farther_out(object, gripper, &candidate.handle) };
        if fits || moved.is_some() {
            candidate.handle = moved.unwrap_or(candidate.handle);
            candidate.handle.name = format!("grasp_{}", kept.len() + 1);
            kept.push(candidate);
        }
    }
    kept.into_iter().map(|candidate| candidate.handle).collect()
}

/// The grasps with one jaw at a point of the surface.
fn about(object: &RigidObject, point: &SurfacePoint, jaws: &Jaws, friction: f64) -> Vec<Candidate> {
    let into = -point.normal;
    let facing = ray(&object.triangles, point.point + into * 1e-6, into);
    // The nearest side that looks the other way: what lies between is solid.
    let Some(&(thick, normal)) = facing.iter().find(|(_, normal)| normal.dot(into) > 0.0) else { return Vec::new() };
    let slant = normal.angle_between(into);
    if slant > friction || !jaws.fits(thick) {
        return Vec::new();
    }
    let middle = point.point + into * (thick / 2.0);
    let x = into.any_orthonormal_vector();
    let approach = |i: usize| DQuat::from_axis_angle(into, TAU * i as f64 / APPROACHES as f64) * x;
    let candidate = |approach: DVec3| {
        // How far the surface reaches ahead of the middle, towards the palm and away from it.
        let reach = |along: DVec3| ray(&object.triangles, middle, along).last().map_or(0.0, |hit| hit.0);
        let (towards, away) = (reach(-approach), reach(approach));
        let behind = jaws.behind(towards + away)?;
        let at = middle - approach * (towards - behind);
        let lever = (at - object.centre).length();
        let cost = slant / friction + 4.0 * lever / object.size + 0.5 * (1.0 - thick / jaws.opening).abs();
        let handle = FoundHandle {
            name: String::new(),
            link_from_handle: frame(at, approach, into),
            clearance: jaws.clearance(behind),
            mask: [true; 6],
            reason: format!("{:.0} mm between the jaws", thick * 1e3),
        };
        Some(Candidate { handle, approach, closing: into, cost })
    };
    (0..APPROACHES).filter_map(|i| candidate(approach(i))).collect()
}
