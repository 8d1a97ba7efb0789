//! Grasps of any surface: two points that face each other, close enough together for the jaws.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::FoundGripper;
use crate::setup::handles::handle::{FoundHandle, HandleSettings, Jaws, ROOM, farther_out, fitted};
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
/// A closing direction is made level that leans less, radians.
const NEARLY_LEVEL: f64 = 0.1;

/// A grasp that may do.
struct Candidate {
    handle: FoundHandle,
    approach: DVec3,
    closing: DVec3,
    /// Smaller is better.
    cost: f64,
}

/// Antipodal grasps, the best first, thinned to those that differ: first such as may turn about the closing direction, then single ones.
pub(super) fn grasps(object: &RigidObject, gripper: &FoundGripper, settings: HandleSettings) -> Vec<FoundHandle> {
    let Some(jaws) = Jaws::of(gripper.kind) else { return Vec::new() };
    let points = random(&object.triangles, settings.samples, settings.seed);
    let lines: Vec<Line> = points.iter().filter_map(|point| line(object, point, &jaws, settings.friction)).collect();
    let turning: Vec<Candidate> = lines.iter().filter_map(|line| turning(line, &jaws)).collect();
    let single: Vec<Candidate> = lines.iter().flat_map(|line| single(line, &jaws)).collect();
    let mut kept: Vec<Candidate> = Vec::new();
    thin(object, gripper, turning, settings.most / 2, &mut kept);
    thin(object, gripper, single, settings.most, &mut kept);
    let named =
        |(at, candidate): (usize, Candidate)| FoundHandle { name: format!("grasp_{}", at + 1), ..candidate.handle };
    kept.into_iter().enumerate().map(named).collect()
}

/// Adds the best candidates that differ from those that are kept and that the hand can take, until there are so many.
fn thin(
    object: &RigidObject,
    gripper: &FoundGripper,
    mut candidates: Vec<Candidate>,
    most: usize,
    kept: &mut Vec<Candidate>,
) {
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut tested = 0;
    for mut candidate in candidates {
        if kept.len() >= most || tested >= TESTED {
            break;
        }
        if kept.iter().any(|other| other.is_like(&candidate)) {
            continue;
        }
        tested += 1;
        // What turns about a line stays on it.
        let may_move = candidate.handle.mask[4];
        let farther = || if may_move { farther_out(object, gripper, &candidate.handle) } else { None };
        if let Some(handle) = fitted(object, gripper, &candidate.handle).or_else(farther) {
            candidate.handle = handle;
            kept.push(candidate);
        }
    }
}

impl Candidate {
    /// Whether it is nearly the same; a grasp that turns is like all that it turns to.
    fn is_like(&self, other: &Self) -> bool {
        let [p, q] = [self, other].map(|grasp| grasp.handle.link_from_handle.translation);
        let turns = !self.handle.mask[4];
        p.distance(q) <= ALIKE.0
            && self.closing.angle_between(other.closing) <= ALIKE.1
            && (turns || self.approach.angle_between(other.approach) <= ALIKE.1)
    }
}

/// Two points of the surface that face each other.
struct Line {
    /// In the middle between them.
    middle: DVec3,
    /// From one to the other, nearly.
    closing: DVec3,
    /// Their distance, metres.
    thick: f64,
    /// By direction of approach: the direction, and how far the surface reaches from the middle towards the palm and away from it, metres.
    reach: Vec<(DVec3, f64, f64)>,
    /// Smaller is better, wherever the hand comes from.
    cost: f64,
}

/// The line with one jaw at a point of the surface.
fn line(object: &RigidObject, point: &SurfacePoint, jaws: &Jaws, friction: f64) -> Option<Line> {
    let into = -point.normal;
    let facing = ray(&object.triangles, point.point + into * 1e-6, into);
    // The nearest side that looks the other way: what lies between is solid.
    let &(thick, normal) = facing.iter().find(|(_, normal)| normal.dot(into) > 0.0)?;
    let slant = normal.angle_between(into);
    if slant > friction || !jaws.fits(thick) {
        return None;
    }
    let closing = levelled((into + normal).try_normalize()?);
    let middle = point.point + into * (thick / 2.0);
    // From above first: that is where most hands come from, and arms with few joints reach it exactly.
    let x = (-DVec3::Z).reject_from_normalized(closing).try_normalize().unwrap_or(closing.any_orthonormal_vector());
    let reach = |i: usize| {
        let approach = DQuat::from_axis_angle(closing, TAU * i as f64 / APPROACHES as f64) * x;
        let far = |along: DVec3| ray(&object.triangles, middle, along).last().map_or(0.0, |hit| hit.0);
        (approach, far(-approach), far(approach))
    };
    let cost = slant / friction + 0.5 * (1.0 - thick / jaws.opening).abs();
    let lever = 4.0 / object.size;
    let reach: Vec<_> = (0..APPROACHES).map(reach).collect();
    Some(Line { middle, closing, thick, reach, cost: cost + lever * middle.distance(object.centre) })
}

/// A closing direction that is nearly level becomes level, as the object stands in its file: arms with few joints hold what stands on a
/// table by such alone.
fn levelled(closing: DVec3) -> DVec3 {
    let level = closing.reject_from_normalized(DVec3::Z).normalize_or(closing);
    if level.angle_between(closing) < NEARLY_LEVEL { level } else { closing }
}

/// The grasp that may turn about the closing direction, where the hand has room for the object from a quarter of all sides or more.
fn turning(line: &Line, jaws: &Jaws) -> Option<Candidate> {
    let room = jaws.depth - ROOM;
    let with_room = || line.reach.iter().filter(move |(_, towards, _)| *towards <= room);
    let far = with_room().map(|(_, towards, _)| *towards).fold(0.0, f64::max);
    let count = with_room().count();
    let &(approach, ..) = with_room().next()?;
    let handle = FoundHandle {
        name: String::new(),
        link_from_handle: jaws.frame(line.middle, approach, line.closing, line.thick),
        clearance: jaws.clearance(far),
        mask: [true, true, true, true, false, true],
        reason: format!("{:.0} mm between the jaws, free to turn about the closing direction", line.thick * 1e3),
    };
    let cost = line.cost + 1.0 - count as f64 / APPROACHES as f64;
    (4 * count >= APPROACHES).then_some(Candidate { handle, approach, closing: line.closing, cost })
}

/// The grasps from single sides.
fn single<'l>(line: &'l Line, jaws: &'l Jaws) -> impl Iterator<Item = Candidate> + 'l {
    line.reach.iter().filter_map(|&(approach, towards, away)| {
        let behind = jaws.behind(towards + away)?;
        let handle = FoundHandle {
            name: String::new(),
            link_from_handle: jaws.frame(
                line.middle - approach * (towards - behind),
                approach,
                line.closing,
                line.thick,
            ),
            clearance: jaws.clearance(behind),
            mask: [true; 6],
            reason: format!("{:.0} mm between the jaws", line.thick * 1e3),
        };
        Some(Candidate { handle, approach, closing: line.closing, cost: line.cost })
    })
}
