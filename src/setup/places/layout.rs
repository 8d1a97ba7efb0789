//! Where objects lie on a table, so that a robot can take each, and put the first one down elsewhere by the same grasp.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::handles::FoundHandle;
use crate::setup::objects::RigidObject;
use crate::setup::places::arm::{Arm, Target};
use crate::setup::places::reach::{Reached, seeds};
use crate::setup::places::table::TableSize;
use crate::setup::places::world::World;
use crate::setup::surfaces::{FoundSurface, lying_on};
use foliate_components::Pose;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Gap between an object and what it lies on, metres: the default of scenes.
pub(crate) const GAP: f64 = 1e-3;
/// Between objects, metres.
const APART: f64 = 0.06;
/// From the edge of the table, metres.
const FROM_EDGE: f64 = 0.03;
/// Distance of the places that are tried, metres.
const GRID: f64 = 0.05;
/// Most places that are tried for an object.
const PLACES: usize = 20;
/// Seeds for each grasp.
const SEEDS: usize = 3;
/// Sides from which a grasp is tried whose turn is free.
const SIDES: usize = 6;
/// How far an object is lifted before it is carried away, metres.
const LIFT: f64 = 0.05;
/// Least and best distance of start and goal, metres.
const WAY: (f64, f64) = (0.1, 0.35);

/// An object that is to be laid down.
pub(crate) struct Item<'a> {
    pub object: &'a RigidObject,
    pub faces: &'a [FoundSurface],
    /// Grippers by number, with their handles of the object.
    pub handles: &'a [(usize, FoundHandle)],
    /// Its part in the world.
    pub part: usize,
}

/// Where an object lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lying {
    /// In the world.
    pub X_WO: Pose,
    /// A circle about the middle that holds its footprint: middle and radius, metres.
    circle: (DVec3, f64),
}

/// Where everything lies.
pub(crate) struct Layout {
    /// By object.
    pub starts: Vec<Lying>,
    /// Where the first one goes.
    pub goal: Pose,
    /// The gripper and the handle that take it there.
    pub grasp: (usize, String),
}

/// What a layout is made with.
pub(crate) struct Maker<'a> {
    pub world: &'a World,
    pub arms: &'a [Arm],
    pub reached: &'a [Vec<Reached>],
    pub X_WT: Pose,
    pub size: TableSize,
    /// The configuration with the fingers open and all objects away.
    pub q: Vec<f64>,
}

impl Maker<'_> {
    /// A layout; `skip` says how many that would do are left out first. The error says which object cannot be taken anywhere.
    pub(crate) fn layout(&self, items: &[Item<'_>], skip: usize) -> Result<Layout, String> {
        let Some((first, others)) = items.split_first() else { return Err("there is no object".into()) };
        let (start, goal, grasp) = self.way(first, skip)?;
        let mut starts = vec![start];
        let mut q = self.q.clone();
        self.world.put(&mut q, first.part, &start.X_WO);
        for item in others {
            let taken: Vec<(DVec3, f64)> = starts.iter().map(|lying| lying.circle).chain([goal.circle]).collect();
            let place = self.spots(item).find(|lying| {
                taken.iter().all(|(middle, radius)| middle.distance(lying.circle.0) > radius + lying.circle.1 + APART)
                    && self.grasps(item, lying, &q, 1).next().is_some()
            });
            let place = place.ok_or_else(|| {
                format!("`{}` can be taken at no place on the table that is left beside the others", item.object.name)
            })?;
            self.world.put(&mut q, item.part, &place.X_WO);
            starts.push(place);
        }
        Ok(Layout { starts, goal: goal.X_WO, grasp })
    }

    /// Two places of an object with one grasp for both.
    fn way(&self, item: &Item<'_>, skip: usize) -> Result<(Lying, Lying, (usize, String)), String> {
        let mut known: Vec<(Lying, Vec<usize>)> = Vec::new();
        let mut found = Vec::new();
        for lying in self.spots(item) {
            let grasps: Vec<usize> = self.grasps(item, &lying, &self.q, usize::MAX).collect();
            for (other, others) in &known {
                let distance = other.X_WO.translation.distance(lying.X_WO.translation);
                let least = WAY.0.max(other.circle.1 + lying.circle.1 + 0.01);
                let shared = grasps.iter().filter(|grasp| others.contains(grasp)).count();
                if distance > least && shared > 0 {
                    let common = grasps.iter().copied().find(|grasp| others.contains(grasp)).unwrap_or(0);
                    // Many grasps in common make it easy; a long way is a better example.
                    let worth = shared.min(6) as f64 + 10.0 * distance.min(WAY.1);
                    found.push((worth, *other, lying, common));
                }
            }
            known.push((lying, grasps));
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        match found.get(skip) {
            Some(&(_, start, goal, common)) => {
                let (gripper, handle) = &item.handles[common];
                Ok((start, goal, (*gripper, handle.name.clone())))
            }
            None => Err(self.why_not(item, &known)),
        }
    }

    /// What is missing for an object to be moved.
    fn why_not(&self, item: &Item<'_>, known: &[(Lying, Vec<usize>)]) -> String {
        let name = &item.object.name;
        let taken = known.iter().filter(|(_, grasps)| !grasps.is_empty()).count();
        match (known.len(), taken) {
            (0, _) => format!("`{name}` fits nowhere on the table ({} x {} m)", self.size.sides.0, self.size.sides.1),
            (places, 0) => format!(
                "none of {} grasps of `{name}` is within reach and free of collision at {places} places on the table",
                item.handles.len()
            ),
            (places, taken) => format!(
                "`{name}` can be taken at {taken} of {places} places on the table, at no two of them by the same grasp"
            ),
        }
    }

    /// Places of an object on the table, those first above which grippers get most often.
    fn spots(&self, item: &Item<'_>) -> impl Iterator<Item = Lying> {
        let mut spots: Vec<(usize, Lying)> = Vec::new();
        let (low, high) = item.object.bounds;
        let radius = (high - low).length() / 2.0;
        let inset = |side: f64| (side / 2.0 - FROM_EDGE - radius.min(side / 4.0)).max(0.0);
        let (far_x, far_y) = (inset(self.size.sides.0), inset(self.size.sides.1));
        let steps = |far: f64| (far / GRID).floor() as i64;
        let ball = FoundSurface { name: String::new(), points: vec![low], normal: -DVec3::Z, reason: String::new() };
        let faces = if item.faces.is_empty() { std::slice::from_ref(&ball) } else { item.faces };
        let face = &faces[0];
        for i in -steps(far_x)..=steps(far_x) {
            for j in -steps(far_y)..=steps(far_y) {
                let p = self.X_WT.transform_point(DVec3::new(i as f64 * GRID, j as f64 * GRID, 0.0));
                let above = p + DVec3::Z * (high - low).max_element() / 2.0;
                let near = |sample: &&Reached| sample.looks_down() && sample.X_WG.translation.distance(above) < 0.15;
                let count = self.reached.iter().flatten().filter(near).count();
                // As seen from the robot, or across.
                let yaw = p.y.atan2(p.x) + if (i + j) % 2 == 0 { 0.0 } else { FRAC_PI_2 };
                let X_WO = lying_on(item.object, face, (p.x, p.y, p.z), GAP, yaw);
                spots.push((count, Lying { X_WO, circle: (p, radius) }));
            }
        }
        spots.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
        spots.into_iter().map(|(_, lying)| lying).take(PLACES)
    }

    /// The numbers of the handles by which an object can be taken where it lies; at most so many.
    fn grasps<'s>(
        &'s self,
        item: &'s Item<'_>,
        lying: &Lying,
        q: &[f64],
        most: usize,
    ) -> impl Iterator<Item = usize> + 's {
        let mut q = q.to_vec();
        let X_WO = lying.X_WO;
        self.world.put(&mut q, item.part, &X_WO);
        let can = move |&at: &usize| self.can_take(item, at, &X_WO, &q);
        (0..item.handles.len()).filter(can).take(most)
    }

    /// Whether a grasp is within reach and free of collision: at the pregrasp, at the grasp, and lifted.
    fn can_take(&self, item: &Item<'_>, at: usize, X_WO: &Pose, q: &[f64]) -> bool {
        let (gripper, handle) = &item.handles[at];
        let arm = &self.arms[*gripper];
        let X_WH = *X_WO * handle.link_from_handle;
        // What approaches from below meets the table.
        let turns_freely = handle.mask[4..].contains(&false);
        if !turns_freely && (X_WH.rotation * DVec3::X).z > 0.3 {
            return false;
        }
        // Seeds from all sides, where the turn is free.
        let sides = if handle.mask[4..].contains(&false) { SIDES } else { 1 };
        let axis = if handle.mask[5] { DVec3::Y } else { DVec3::Z };
        (0..sides).any(|side| {
            let turn = DQuat::from_axis_angle(axis, TAU * side as f64 / SIDES as f64);
            let target = Target { X_WH: X_WH * Pose::from_rotation(turn), mask: handle.mask };
            let near = seeds(&self.reached[*gripper], &target.X_WH, SEEDS);
            near.into_iter().any(|seed| self.takes(item, arm, handle, (&target, seed, q)))
        })
    }

    fn takes(
        &self,
        item: &Item<'_>,
        arm: &Arm,
        handle: &FoundHandle,
        (target, seed, q): (&Target, &Reached, &[f64]),
    ) -> bool {
        let (world, robot) = (self.world, &self.world.robot);
        let mut X_WJ = world.bodies();
        // The arm as in the seed, objects where they are.
        let mut at = q.to_vec();
        let first_object = robot.parts.iter().filter_map(|part| part.root_joint).next();
        let end = first_object.and_then(|root| crate::setup::grippers::coordinate(robot, root)).unwrap_or(at.len());
        at[..end].copy_from_slice(&seed.q[..end]);
        if !arm.reach(robot, &world.kinematics, target, &mut at, &mut X_WJ)
            || !world.is_free(&X_WJ, Some((arm.body, item.part)), 0.0)
        {
            return false;
        }
        let X_WG = arm.gripper(&X_WJ);
        let before = X_WG * Pose::from_translation(-DVec3::X * handle.clearance);
        let lifted = Pose::from_parts(X_WG.translation + DVec3::Z * LIFT, X_WG.rotation);
        let mut reaches = |X_WH: Pose, holds: Option<(_, usize)>| {
            let mut q = at.clone();
            let whole = Target { X_WH, mask: [true; 6] };
            arm.reach(robot, &world.kinematics, &whole, &mut q, &mut X_WJ) && world.is_free(&X_WJ, holds, 0.0)
        };
        reaches(before, None) && reaches(lifted, Some((arm.body, item.part)))
    }
}
