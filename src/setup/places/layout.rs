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
use foliate_components::robot::LinkIndex;
use glam::{DQuat, DVec3};
use std::cell::RefCell;
use std::collections::BTreeMap;
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
/// How often an object is turned to a hand: where it turns about a place beside the jaws, the hand comes otherwise each time.
const TURNED: usize = 10;
/// Pairs of places that are compared by the turns of their grasps.
const COMPARED: usize = 40;
/// Turns of a grasp that are compared.
const TURNS: usize = 4;
/// The first part that is an object, after robot and table.
const FIRST_OBJECT: usize = 2;
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
    /// What stopped tries to take an object, and how often: where, and which links met where it was not the reach.
    pub stops: RefCell<BTreeMap<Stop, usize>>,
}

/// Where a try to take an object ended, and the links that met there.
pub(crate) type Stop = (&'static str, Option<[LinkIndex; 2]>);

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
            let common = shared.iter().copied().find(|&at| self.is_same(item, at, [&start.X_WO, &goal.X_WO]))?;
            let (gripper, handle) = &item.handles[common];
            Some((*start, *goal, (*gripper, handle.name.clone())))
        });
        alike.nth(skip).ok_or_else(|| self.why_not(item, &known))
    }

    /// Whether an object can be taken at both places by a handle in the same way: where its turn is free, by the same turn.
    fn is_same(&self, item: &Item<'_>, at: usize, [from, to]: [&Pose; 2]) -> bool {
        let (gripper, handle) = &item.handles[at];
        if handle.mask == [true; 6] {
            return true;
        }
        let mut q = self.q.clone();
        self.world.put(&mut q, item.part, from);
        let turns = self.turns(item, (*gripper, handle), from, &q).step_by(2).take(TURNS);
        let turns: Vec<Pose> = turns.collect();
        self.world.put(&mut q, item.part, to);
        turns.into_iter().any(|X_HG| {
            let link_from_handle = handle.link_from_handle * X_HG;
            let fixed = FoundHandle { link_from_handle, mask: [true; 6], ..handle.clone() };
            self.turns(item, (*gripper, &fixed), to, &q).next().is_some()
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
                self.stopped()
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
                let count = self.reached.iter().flatten().filter(near).count();
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
        let (world, arm) = (self.world, &self.arms[*gripper]);
        let mut X_WO = lying.X_WO;
        let seed = seeds(&self.reached[*gripper], &(X_WO * handle.link_from_handle), 1).into_iter().next()?;
        let (mut q, mut X_WJ) = (seed.q.clone(), world.bodies());
        for _ in 0..TURNED {
            let X_WH = X_WO * handle.link_from_handle;
            let target = Target { X_WH, mask: [true, true, true, false, false, false], is_level: true };
            if !arm.reach(&world.robot, &world.kinematics, &target, &mut q, &mut X_WJ) {
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
        self.world.put(&mut q, item.part, &X_WO);
        let can = move |&at: &usize| self.can_take(item, at, &X_WO, &q);
        (0..item.handles.len()).filter(can).take(most)
    }

    /// Whether a grasp is within reach and free of collision: at the pregrasp, at the grasp, and lifted.
    fn can_take(&self, item: &Item<'_>, at: usize, X_WO: &Pose, q: &[f64]) -> bool {
        let (gripper, handle) = &item.handles[at];
        self.turns(item, (*gripper, handle), X_WO, q).next().is_some()
    }

    /// The poses of the gripper in a handle by which an object can be taken, as far as they are found from seeds on all sides.
    fn turns<'s>(
        &'s self,
        item: &'s Item<'_>,
        (gripper, handle): (usize, &'s FoundHandle),
        X_WO: &Pose,
        q: &'s [f64],
    ) -> impl Iterator<Item = Pose> + 's {
        let X_WH = *X_WO * handle.link_from_handle;
        // What approaches from below meets the table.
        let turns_freely = handle.mask[4..].contains(&false);
        let is_below = !turns_freely && (X_WH.rotation * DVec3::X).z > 0.3;
        // Seeds from all sides, where the turn is free.
        let sides = if is_below {
            0
        } else if turns_freely {
            SIDES
        } else {
            1
        };
        let axis = if handle.mask[5] { DVec3::Y } else { DVec3::Z };
        let seeded = (0..sides).flat_map(move |side| {
            let turn = DQuat::from_axis_angle(axis, TAU * side as f64 / SIDES as f64);
            let target = Target { X_WH: X_WH * Pose::from_rotation(turn), mask: handle.mask, is_level: false };
            seeds(&self.reached[gripper], &target.X_WH, SEEDS).into_iter().map(move |seed| (target, seed))
        });
        seeded.filter_map(move |(target, seed)| {
            let taken = self.takes(item, &self.arms[gripper], handle, (&target, seed, q));
            taken
                .map_err(|stop| *self.stops.borrow_mut().entry(stop).or_default() += 1)
                .ok()
                .map(|X_WG| X_WH.inverse() * X_WG)
        })
    }

    /// The gripper where it takes an object.
    fn takes(
        &self,
        item: &Item<'_>,
        arm: &Arm,
        handle: &FoundHandle,
        (target, seed, q): (&Target, &Reached, &[f64]),
    ) -> Result<Pose, Stop> {
        let (world, robot) = (self.world, &self.world.robot);
        let mut X_WJ = world.bodies();
        // The arm as in the seed, objects where they are.
        let mut at = q.to_vec();
        let first_object = robot.parts[FIRST_OBJECT..].iter().find_map(|part| part.root_joint);
        let end = first_object.and_then(|root| crate::setup::grippers::coordinate(robot, root)).unwrap_or(at.len());
        at[..end].copy_from_slice(&seed.q[..end]);
        if !arm.reach(robot, &world.kinematics, target, &mut at, &mut X_WJ) {
            return Err(("at the grasp", None));
        }
        if let Some(meeting) = world.meeting(&X_WJ, Some((arm.body, item.part)), 0.0) {
            return Err(("at the grasp", Some(meeting.links)));
        }
        let X_WG = arm.gripper(&X_WJ);
        let before = X_WG * Pose::from_translation(-DVec3::X * handle.clearance);
        let lifted = Pose::from_parts(X_WG.translation + DVec3::Z * LIFT, X_WG.rotation);
        let mut reaches = |place: &'static str, X_WH: Pose, holds: Option<(_, usize)>| {
            let mut q = at.clone();
            let whole = Target { X_WH, mask: [true; 6], is_level: false };
            if !arm.reach(robot, &world.kinematics, &whole, &mut q, &mut X_WJ) {
                return Err((place, None));
            }
            world.meeting(&X_WJ, holds, 0.0).map_or(Ok(()), |meeting| Err((place, Some(meeting.links))))
        };
        reaches("before the grasp", before, None)?;
        reaches("where it is lifted", lifted, Some((arm.body, item.part)))?;
        Ok(X_WG)
    }

    /// What stopped most tries, in words.
    fn stopped(&self) -> String {
        let stops = self.stops.borrow();
        let all: usize = stops.values().sum();
        let mut ranked: Vec<(&Stop, &usize)> = stops.iter().collect();
        ranked.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let name = |link: &LinkIndex| self.world.robot.links[link.at()].name.clone();
        let words = ranked.into_iter().take(3).map(|((place, links), count)| {
            let what = match links {
                None => format!("out of reach {place}"),
                Some([a, b]) => format!("{place} `{}` meets `{}`", name(a), name(b)),
            };
            format!("{what} ({:.0} % of {all} tries)", 100.0 * *count as f64 / all.max(1) as f64)
        });
        words.collect::<Vec<_>>().join(", ")
    }
}
