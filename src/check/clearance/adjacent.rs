//! Which links are neighbours, from the models: the two links that one joint joins, where they touch wherever that joint is.
//!
//! A link without shapes that fixed joints join to others does not separate neighbours. A pair that touches at some values
//! of the joint only is tested like any other.

use crate::check::clearance::enclosure::is_inside;
use crate::check::distance::measured::{Measured, exact};
use crate::check::world::models::{Body, Value, World, ordered};
use crate::path_file::document::PathFile;
use foliate_components::Pose;
use foliate_components::robot::JointType;
use foliate_components::robot::model::{JointKind, Model};
use glam::DQuat;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Values of a joint at which its links are tested, evenly over its range, both ends included.
const SAMPLES: usize = 17;
/// Links that are no farther apart than this touch, metres: the accuracy of distances.
const TOUCH: f64 = 1e-6;

/// Shapes of all links, by name, and how joints move.
pub(crate) struct Neighbours<'w> {
    world: &'w World,
    file: &'w PathFile,
    measured: Vec<Measured>,
    /// Shapes by link.
    shapes: HashMap<&'w str, Vec<usize>>,
}

impl<'w> Neighbours<'w> {
    pub(crate) fn new(world: &'w World, file: &'w PathFile) -> Self {
        let mut shapes: HashMap<&str, Vec<usize>> = HashMap::new();
        for (index, shape) in world.shapes.iter().enumerate() {
            shapes.entry(shape.link.as_str()).or_default().push(index);
        }
        Self { world, file, measured: Measured::all(world), shapes }
    }

    /// Whether both links have shapes.
    pub(crate) fn have_shapes(&self, first: &str, second: &str) -> bool {
        self.shapes.contains_key(first) && self.shapes.contains_key(second)
    }

    /// Whether two links, by `part/link`, are neighbours.
    pub(crate) fn are(&self, first: &str, second: &str) -> bool {
        let of_one_part = || {
            let (part, one) = first.split_once('/')?;
            let (same, other) = second.split_once('/')?;
            (part == same).then_some((self.world.part(part)?, one, other))
        };
        let Some((part, one, other)) = of_one_part() else { return false };
        let model = &self.world.parts[part].model;
        let number = |name: &str| model.links.iter().position(|link| link.name == name);
        let (Some(one), Some(other)) = (number(one), number(other)) else { return false };
        let joins = |parent: usize, child: usize, joint: &foliate_components::robot::model::JointModel| {
            seen(model, joint.parent).contains(&parent) && seen(model, joint.child).contains(&child)
        };
        model.joints.iter().filter(|joint| joint.kind != JointKind::Fixed).any(|joint| {
            let of_joint = || self.body(part, &joint.name);
            (joins(one, other, joint) && self.touch(of_joint(), first, second))
                || (joins(other, one, joint) && self.touch(of_joint(), second, first))
        })
    }

    fn body(&self, part: usize, joint: &str) -> Option<&'w Body> {
        let name = format!("{}/{joint}", self.world.parts[part].name);
        self.world.bodies[self.world.parts[part].bodies.clone()].iter().find(|body| body.name == name)
    }

    /// Whether shapes of a link on a joint's parent body touch shapes of one beyond it, or lie inside each other, wherever the
    /// joint is.
    fn touch(&self, body: Option<&Body>, inner: &str, outer: &str) -> bool {
        let Some((body, range)) = body.and_then(|body| Some((body, self.range(body)?))) else { return false };
        let none = Vec::new();
        let of = |link: &str| self.shapes.get(link).unwrap_or(&none);
        let (inner, outer) = (of(inner), of(outer));
        (0..SAMPLES).all(|sample| {
            let value = range.0 + (range.1 - range.0) * sample as f64 / (SAMPLES - 1) as f64;
            let moved = match body.motion {
                JointType::Revolute { axis } => Pose::from_rotation(DQuat::from_axis_angle(axis, value)),
                JointType::Prismatic { axis } => Pose::from_translation(axis * value),
                JointType::Planar | JointType::FreeFlyer => return false,
            };
            let beyond = body.parent_from_joint * moved;
            let meet = |&(&a, &b): &(&usize, &usize)| {
                let (one, other) = (&self.measured[a], &self.measured[b]);
                let (here, there) = (one.in_world(Pose::identity()), other.in_world(beyond));
                let shapes = [a, b].map(|shape| &self.world.shapes[shape].geometry);
                exact((one, here), (other, there), &mut None).value <= TOUCH
                    || is_inside(shapes[1], shapes[0], &(here.inverse() * there))
                    || is_inside(shapes[0], shapes[1], &(there.inverse() * here))
            };
            inner.iter().flat_map(|a| outer.iter().map(move |b| (a, b))).any(|pair| meet(&pair))
        })
    }

    /// The range of a joint: the file's, or the model's; a full turn where it turns without end.
    fn range(&self, body: &Body) -> Option<(f64, f64)> {
        let of_file = match &body.value {
            Value::Columns(columns) => self.file.limits.get(&self.file.coordinates[columns[0]]),
            Value::Follows { .. } | Value::Still => None,
        };
        let (low, high) = of_file.map_or(body.limits, |[low, high]| (*low, *high));
        match body.motion {
            JointType::Revolute { .. } if !(low.is_finite() && high.is_finite()) => Some((-PI, PI)),
            _ => (low.is_finite() && high.is_finite()).then_some((low, high)),
        }
    }
}

/// The links with shapes that a joint's end is about: its own link, or, where that has no shapes, those that fixed joints
/// join to it.
fn seen(model: &Model, link: usize) -> Vec<usize> {
    let (mut found, mut open, mut known) = (Vec::new(), vec![link], vec![false; model.links.len()]);
    while let Some(link) = open.pop() {
        if std::mem::replace(&mut known[link], true) {
            continue;
        }
        if !model.links[link].shapes.is_empty() {
            found.push(link);
            continue;
        }
        for joint in model.joints.iter().filter(|joint| joint.kind == JointKind::Fixed) {
            if joint.parent == link {
                open.push(joint.child);
            } else if joint.child == link {
                open.push(joint.parent);
            }
        }
    }
    found
}

/// Pairs of links of the file that it calls neighbours, the smaller name first.
pub(crate) fn claimed(file: &PathFile) -> impl Iterator<Item = (String, String)> {
    file.ignored_pairs.iter().filter(|[.., reason]| reason == ADJACENT).map(|[first, second, _]| ordered(first, second))
}

/// The reason by which files name neighbours.
pub(crate) const ADJACENT: &str = "adjacent";
