//! Where objects lie on a table, so that a robot can take each, and put the first one down elsewhere by the same grasp.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::handles::FoundHandle;
use crate::setup::places::arm::Target;
use crate::setup::places::reach::{Reached, seeds};
use crate::setup::places::table::TableSize;
use crate::setup::places::taking::{Item, Taken, Taker};
use crate::setup::surfaces::{FoundSurface, lying_on};
use foliate_components::Pose;
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

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
/// How often an object is turned to a hand: where it turns about a place beside the jaws, the hand comes otherwise each time.
const TURNED: usize = 10;
/// Pairs of places that are compared by the turns of their grasps.
const COMPARED: usize = 40;
/// Turns of a grasp that are compared.
const TURNS: usize = 4;
/// Least and best distance of start and goal, metres.
const WAY: (f64, f64) = (0.1, 0.35);

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
    /// How closely the gripper meets that grasp at both places: the largest residual, metres and radians.
    pub residual: f64,
}

/// Two places of an object with one grasp for both.
struct Way {
    start: Lying,
    goal: Lying,
    grasp: (usize, String),
    residual: f64,
}

/// What a layout is made with.
pub(crate) struct Maker<'a> {
    pub taker: Taker<'a>,
    pub X_WT: Pose,
    pub size: TableSize,
    /// The configuration with the fingers open and all objects away.
    pub q: Vec<f64>,
}

impl Maker<'_> {
    /// A layout; `skip` says how many that would do are left out first. The error says which object cannot be taken anywhere.
    pub(crate) fn layout(&self, items: &[Item<'_>], skip: usize) -> Result<Layout, String> {
        let Some((first, others)) = items.split_first() else { return Err("there is no object".into()) };
        let Way { start, goal, grasp, residual } = self.way(first, skip)?;
        let mut starts = vec![start];
        let mut q = self.q.clone();
        self.taker.world.put(&mut q, first.part, &start.X_WO);
        for item in others {
            let taken: Vec<(DVec3, f64)> = starts.iter().map(|lying| lying.circle).chain([goal.circle]).collect();
            let place = self.spots(item).find(|lying| {
                taken.iter().all(|(middle, radius)| middle.distance(lying.circle.0) > radius + lying.circle.1 + APART)
                    && self.grasps(item, lying, &q, 1).next().is_some()
            });
            let place = place.ok_or_else(|| {
                format!("`{}` can be taken at no place on the table that is left beside the others", item.object.name)
            })?;
            self.taker.world.put(&mut q, item.part, &place.X_WO);
            starts.push(place);
        }
        Ok(Layout { starts, goal: goal.X_WO, grasp, residual })
    }

    /// The way of an object; `skip` says how many better ones are left out.
    fn way(&self, item: &Item<'_>, skip: usize) -> Result<Way, String> {
        let mut known: Vec<(Lying, Vec<usize>)> = Vec::new();
        let mut found = Vec::new();
        for lying in self.spots(item) {
            let grasps: Vec<usize> = self.grasps(item, &lying, &self.q, usize::MAX).collect();
            for (other, others) in &known {
                let distance = other.X_WO.translation.distance(lying.X_WO.translation);
                let least = WAY.0.max(other.circle.1 + lying.circle.1 + 0.01);
                let shared: Vec<usize> = grasps.iter().copied().filter(|grasp| others.contains(grasp)).collect();
                if distance > least && !shared.is_empty() {
                    // Many grasps in common make it easy; a long way is a better example.
                    let worth = shared.len().min(6) as f64 + 10.0 * distance.min(WAY.1);
                    found.push((worth, *other, lying, shared));
                }
            }
            known.push((lying, grasps));
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut alike = found.iter().take(COMPARED).filter_map(|(_, start, goal, shared)| {
            let same = |&at: &usize| Some((at, self.same(item, at, [&start.X_WO, &goal.X_WO])?));
            let (common, residual) = shared.iter().find_map(same)?;
            let (gripper, handle) = &item.handles[common];
            Some(Way { start: *start, goal: *goal, grasp: (*gripper, handle.name.clone()), residual })
        });
        alike.nth(skip).ok_or_else(|| self.why_not(item, &known))
    }

    /// How closely an object is taken at both places by a handle in the same way: where its turn is free, by the same turn. None where it
    /// cannot be.
    fn same(&self, item: &Item<'_>, at: usize, [from, to]: [&Pose; 2]) -> Option<f64> {
        let (gripper, handle) = &item.handles[at];
        let [mut q_from, mut q_to] = [self.q.clone(), self.q.clone()];
        self.taker.world.put(&mut q_from, item.part, from);
        self.taker.world.put(&mut q_to, item.part, to);
        let (every, most) = if handle.mask == [true; 6] { (1, 1) } else { (2, TURNS) };
        let turns = self.taker.turns(item, (*gripper, handle), from, &q_from).step_by(every).take(most);
        let turns: Vec<Taken> = turns.collect();
        turns.into_iter().find_map(|taken| {
            let link_from_handle = match handle.mask == [true; 6] {
                true => handle.link_from_handle,
                false => handle.link_from_handle * taken.X_HG,
            };
            let fixed = FoundHandle { link_from_handle, mask: [true; 6], ..handle.clone() };
            let there = self.taker.turns(item, (*gripper, &fixed), to, &q_to).next()?;
            Some(taken.residual.max(there.residual))
        })
    }

    /// What is missing for an object to be moved.
    fn why_not(&self, item: &Item<'_>, known: &[(Lying, Vec<usize>)]) -> String {
        let name = &item.object.name;
        let taken = known.iter().filter(|(_, grasps)| !grasps.is_empty()).count();
        match (known.len(), taken) {
            (0, _) => format!("`{name}` fits nowhere on the table ({} x {} m)", self.size.sides.0, self.size.sides.1),
            (places, 0) => format!(
                "none of {} grasps of `{name}` is within reach and free of collision at {places} places on the table: {}",
                item.handles.len(),
                self.taker.stopped()
            ),
            (places, taken) => format!(
                "`{name}` can be taken at {taken} of {places} places on the table, at no two of them by the same grasp"
            ),
        }
    }

    /// Places of an object on the table, those first above which grippers get most often.
    fn spots(&self, item: &Item<'_>) -> impl Iterator<Item = Lying> {
        let mut spots: Vec<(usize, bool, Lying)> = Vec::new();
        let (low, high) = item.object.bounds;
        let ball = FoundSurface { name: String::new(), points: vec![low], normal: -DVec3::Z, reason: String::new() };
        let faces = if item.faces.is_empty() { std::slice::from_ref(&ball) } else { item.faces };
        let face = &faces[0];
        let at_origin = lying_on(item.object, face, (0.0, 0.0, 0.0), 0.0, 0.0);
        let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
        let radius = (0..8).map(|i| at_origin.transform_point(corner(i)).truncate().length()).fold(0.0, f64::max);
        let inset = |side: f64| (side / 2.0 - FROM_EDGE - radius.min(side / 4.0)).max(0.0);
        let (far_x, far_y) = (inset(self.size.sides.0), inset(self.size.sides.1));
        // From the edge that is nearest to the robot.
        let towards = self.X_WT.inverse_transform_point(DVec3::ZERO).y.signum();
        let count = |far: f64| (2.0 * far / GRID).floor() as usize + 1;
        for i in 0..count(far_x) {
            for j in 0..count(far_y) {
                let local = DVec3::new(i as f64 * GRID - far_x, towards * (far_y - j as f64 * GRID), 0.0);
                let p = self.X_WT.transform_point(local);
                let above = p + DVec3::Z * (high - low).max_element() / 2.0;
                let near = |sample: &&Reached| sample.looks_down() && sample.X_WG.translation.distance(above) < 0.15;
                let count = self.taker.reached.iter().flatten().filter(near).count();
                // As seen from the robot, or across.
                let yaw = p.y.atan2(p.x) + if (i + j) % 2 == 0 { 0.0 } else { FRAC_PI_2 };
                let X_WO = lying_on(item.object, face, (p.x, p.y, p.z), GAP, yaw);
                spots.push((count, (i + j) % 2 == 0, Lying { X_WO, circle: (p, radius) }));
            }
        }
        spots.sort_by_key(|(count, ..)| std::cmp::Reverse(*count));
        let turned =
            move |(_, turns, lying): (usize, bool, Lying)| match turns.then(|| self.turned(item, &lying)).flatten() {
                Some(X_WO) => Lying { X_WO, ..lying },
                None => lying,
            };
        spots.into_iter().take(PLACES).map(turned)
    }

    /// An object turned about the vertical as the nearest hand comes with level jaws, for its first handle that turns about the closing
    /// direction: arms with few joints come to a place in one way alone.
    fn turned(&self, item: &Item<'_>, lying: &Lying) -> Option<Pose> {
        let (gripper, handle) = item.handles.iter().find(|(_, handle)| !handle.mask[4] && handle.mask[3])?;
        let (world, arm) = (self.taker.world, &self.taker.arms[*gripper]);
        let mut X_WO = lying.X_WO;
        let X_WH = X_WO * handle.link_from_handle;
        let mut q = seeds(world, arm, &self.taker.reached[*gripper], &X_WH, 1).into_iter().next()?;
        let mut X_WJ = world.bodies();
        for _ in 0..TURNED {
            let X_WH = X_WO * handle.link_from_handle;
            let target = Target { X_WH, mask: [true, true, true, false, false, false], is_level: true };
            if !arm.reach(&world.robot, &world.kinematics, &target, (&mut q, &[]), &mut X_WJ) {
                return None;
            }
            let [is, wanted] = [X_WH, arm.gripper(&X_WJ)].map(|pose| pose.rotation * DVec3::Y);
            let yaw = wanted.y.atan2(wanted.x) - is.y.atan2(is.x);
            let middle = lying.circle.0;
            let turn = Pose::from_parts(middle, DQuat::from_rotation_z(yaw)) * Pose::from_translation(-middle);
            X_WO = turn * X_WO;
        }
        Some(X_WO)
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
        self.taker.world.put(&mut q, item.part, &X_WO);
        let can = move |&at: &usize| self.can_take(item, at, &X_WO, &q);
        (0..item.handles.len()).filter(can).take(most)
    }

    /// Whether a grasp is within reach and free of collision: at the pregrasp, at the grasp, and lifted.
    fn can_take(&self, item: &Item<'_>, at: usize, X_WO: &Pose, q: &[f64]) -> bool {
        let (gripper, handle) = &item.handles[at];
        self.taker.turns(item, (*gripper, handle), X_WO, q).next().is_some()
    }
}
