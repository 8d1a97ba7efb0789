//! How a hand takes an object where it lies: postures at the grasp, before it and lifted, free of collision.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::setup::grippers::FoundGripper;
use crate::setup::handles::{FoundHandle, can_take_turned};
use crate::setup::objects::RigidObject;
use crate::setup::places::arm::{Arm, Target};
use crate::setup::places::reach::{Reached, seeds};
use crate::setup::places::world::{Meeting, World};
use crate::setup::surfaces::FoundSurface;
use foliate_components::Pose;
use foliate_components::robot::LinkIndex;
use glam::{DQuat, DVec3};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Seeds for each grasp.
const SEEDS: usize = 3;
/// Tries from one seed: each but the first keeps joints of the seed.
const AGAIN: usize = 8;
/// Sides from which a grasp is tried whose turn is free.
const SIDES: usize = 6;
/// An arm of so many coordinates meets every pose within its reach.
const ALL_POSES: usize = 6;
/// The first part that is an object, after robot and table.
const FIRST_OBJECT: usize = 2;
/// How far an object is lifted before it is carried away, metres.
const LIFT: f64 = 0.05;

/// An object that is to be laid down.
pub(crate) struct Item<'a> {
    pub object: &'a RigidObject,
    pub faces: &'a [FoundSurface],
    /// Grippers by number, with their handles of the object.
    pub handles: &'a [(usize, FoundHandle)],
    /// Its part in the world.
    pub part: usize,
}

/// A grasp that a hand takes.
#[derive(Clone, Copy)]
pub(crate) struct Taken {
    /// The gripper in the handle.
    pub X_HG: Pose,
    /// The largest residual at pregrasp, grasp and lift, metres and radians.
    pub residual: f64,
}

/// Where a try to take an object ended, and the links that met there.
pub(crate) type Stop = (&'static str, Option<[LinkIndex; 2]>);

/// The hands that take objects, and what stopped them.
pub(crate) struct Taker<'a> {
    pub world: &'a World,
    pub arms: &'a [Arm],
    pub grippers: &'a [FoundGripper],
    pub reached: &'a [Vec<Reached>],
    /// What stopped tries to take an object, and how often: where, and which links met where it was not the reach.
    pub stops: RefCell<BTreeMap<Stop, usize>>,
}

impl Taker<'_> {
    /// The grasps of a handle by which an object can be taken, as far as they are found from seeds on all sides.
    pub(crate) fn turns<'s>(
        &'s self,
        item: &'s Item<'_>,
        (gripper, handle): (usize, &'s FoundHandle),
        X_WO: &Pose,
        q: &'s [f64],
    ) -> impl Iterator<Item = Taken> + 's {
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
            let X_WH = X_WH * Pose::from_rotation(turn);
            let target = Target { X_WH, mask: handle.mask, is_level: false };
            let near = seeds(self.world, &self.arms[gripper], &self.reached[gripper], &target.X_WH, SEEDS);
            near.into_iter().map(move |seed| (target, seed))
        });
        seeded.filter_map(move |(target, seed)| {
            let taken = self.takes(item, (gripper, handle), &X_WH, (&target, &seed, q));
            taken.map_err(|stop| *self.stops.borrow_mut().entry(stop).or_default() += 1).ok()
        })
    }

    /// A grasp from a seed; the handle is at `X_WH`, turned as the target wants it.
    fn takes(
        &self,
        item: &Item<'_>,
        (gripper, handle): (usize, &FoundHandle),
        X_WH: &Pose,
        (target, seed, q): (&Target, &[f64], &[f64]),
    ) -> Result<Taken, Stop> {
        let (world, robot, arm) = (self.world, &self.world.robot, &self.arms[gripper]);
        let mut X_WJ = world.bodies();
        // The arm as in the seed, objects where they are.
        let mut at = q.to_vec();
        let first_object = robot.parts[FIRST_OBJECT..].iter().find_map(|part| part.root_joint);
        let end = first_object.and_then(|root| crate::setup::grippers::coordinate(robot, root)).unwrap_or(at.len());
        at[..end].copy_from_slice(&seed[..end]);
        // What meets at the grasp met nowhere in the seed: the joints between stay there, and others come instead.
        let (from, mut held) = (at.clone(), Vec::new());
        for tries_left in (0..AGAIN).rev() {
            if !arm.reach(robot, &world.kinematics, target, (&mut at, &held), &mut X_WJ) {
                return Err(("at the grasp", None));
            }
            let Some(meeting) = world.meeting(&X_WJ, Some((arm.body, item.part)), 0.0) else { break };
            let known = held.len();
            let parting = self.parting(&meeting, arm, (&from, &at), end);
            let further: Vec<usize> = parting.into_iter().filter(|at| !held.contains(at)).collect();
            held.extend(further);
            if tries_left == 0 || held.len() == known {
                return Err(("at the grasp", Some(meeting.links)));
            }
            at.copy_from_slice(&from);
        }
        let X_WG = arm.gripper(&X_WJ);
        let X_HG = X_WH.inverse() * X_WG;
        // A handle fits the hand at some turn of those that are free.
        let is_turned = handle.mask[3..].contains(&false);
        if is_turned && !can_take_turned(item.object, &self.grippers[gripper], handle, &X_HG.inverse()) {
            return Err(("at the grasp", Some(self.hand_and_object(arm, item))));
        }
        let exactly = |target: &Target, q: &[f64], X_WJ: &mut [Pose]| match arm.coordinates(robot) < ALL_POSES {
            true => arm.residual(robot, &world.kinematics, target, (&mut q.to_vec(), &held), X_WJ),
            false => 0.0,
        };
        let mut residual = exactly(target, &at, &mut X_WJ);
        let before = X_WG * Pose::from_translation(-DVec3::X * handle.clearance);
        let lifted = Pose::from_parts(X_WG.translation + DVec3::Z * LIFT, X_WG.rotation);
        let mut reaches = |place: &'static str, X_WH: Pose, holds: Option<(_, usize)>| {
            let mut q = at.clone();
            let whole = Target { X_WH, mask: [true; 6], is_level: false };
            if !arm.reach(robot, &world.kinematics, &whole, (&mut q, &held), &mut X_WJ) {
                return Err((place, None));
            }
            residual = residual.max(exactly(&whole, &q, &mut X_WJ.clone()));
            world.meeting(&X_WJ, holds, 0.0).map_or(Ok(()), |meeting| Err((place, Some(meeting.links))))
        };
        reaches("before the grasp", before, None)?;
        reaches("where it is lifted", lifted, Some((arm.body, item.part)))?;
        Ok(Taken { X_HG, residual })
    }

    /// A link that carries a gripper, and one of an object.
    fn hand_and_object(&self, arm: &Arm, item: &Item<'_>) -> [LinkIndex; 2] {
        let links = || self.world.robot.links.iter();
        let hand = links().position(|link| link.part.at() == 0 && link.joint == arm.body);
        let object = links().position(|link| link.part.at() == item.part);
        [hand, object].map(|link| LinkIndex(link.unwrap_or_default() as u32))
    }

    /// The coordinate between two bodies that meet which parts them where it alone is as in the seed, or else all between; not those of a base.
    fn parting(&self, meeting: &Meeting, arm: &Arm, (from, at): (&[f64], &[f64]), end: usize) -> Vec<usize> {
        let world = self.world;
        let mut between = world.between(meeting.bodies);
        between.retain(|&coordinate| coordinate < end && !arm.drives_by(&world.robot, coordinate));
        let mut X_WJ = world.bodies();
        let parts = |coordinate: &&usize| {
            let mut q = at.to_vec();
            q[**coordinate] = from[**coordinate];
            world.kinematics.forward(&q, &mut X_WJ);
            world.are_apart(meeting.links, &X_WJ)
        };
        let single = between.iter().find(parts).copied();
        single.map_or(between, |coordinate| vec![coordinate])
    }

    /// What stopped most tries, in words.
    pub(crate) fn stopped(&self) -> String {
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
