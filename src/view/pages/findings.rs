//! What is wrong at a configuration: pairs that collide, with how deep and where, and what else keeps it from being a start or a goal.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::view::document::finding::{CollisionEntry, ViolationEntry, WhereEntry};
use crate::view::document::page::Document;
use foliate_components::Pose;
use foliate_components::infeasibility::{CollidingPair, Infeasibility};
use foliate_components::problem::{Correction, Moved};
use foliate_components::robot::{Robot, ShapeIndex};
use foliate_kernels::collision::depth::{PlacedSolid, deepest};
use foliate_kernels::collision::distance::witness::witnesses;
use foliate_kernels::collision::{CollisionScene, DistanceQuery, PairId, clearance, contained, pair_clearance};
use foliate_kernels::kinematics::Kinematics;
use glam::DVec3;

/// A robot's shapes where a configuration has them.
pub(crate) struct Placed<'a> {
    pub robot: &'a Robot,
    pub scene: &'a CollisionScene,
    pub X_WJ: Vec<Pose>,
    pub at: WhereEntry,
}

impl<'a> Placed<'a> {
    pub fn new(robot: &'a Robot, scene: &'a CollisionScene, q: &[f64], at: WhereEntry) -> Self {
        let kinematics = Kinematics::new(robot);
        let X_WJ = kinematics.poses(q);
        Self { robot, scene, X_WJ, at }
    }

    fn solid(&self, shape: ShapeIndex) -> PlacedSolid<'_> {
        let solid = &self.scene.solids()[shape.at()];
        let pose = solid.body.map_or(Pose::identity(), |body| self.X_WJ[body.at()]) * solid.X_JS;
        PlacedSolid { geometry: &self.robot.shapes[shape.at()].geometry, solid: &solid.solid, pose }
    }

    /// What a pair of shapes has to tell; nothing where one is a placeholder.
    pub fn collision(&self, shapes: [ShapeIndex; 2], words: String) -> Option<CollisionEntry> {
        if shapes.iter().any(|shape| self.robot.shapes[shape.at()].geometry.missing_file().is_some()) {
            return None;
        }
        let [a, b] = shapes.map(|shape| self.solid(shape));
        let deepest = deepest(a, b);
        let ask = DistanceQuery::exact(f64::MAX);
        let distance = clearance(a.solid, &a.pose, b.solid, &b.pose, ask, &mut DVec3::ZERO.clone());
        let apart = witnesses(a.solid, &a.pose, b.solid, &b.pose, distance).filter(|_| deepest.is_none());
        let point = deepest.map(|(_, point)| point).or(apart.map(|[p, q]| 0.5 * (p + q)));
        Some(CollisionEntry {
            configuration: self.at.clone(),
            links: shapes.map(|shape| self.robot.shapes[shape.at()].link.at()),
            depth: deepest.map(|(depth, _)| depth),
            distance: Some(distance).filter(|d| deepest.is_none() && *d > 0.0 && d.is_finite()),
            point: point.map(|point| point.to_array()),
            points: apart.map(|points| points.map(|point| point.to_array())),
            words,
        })
    }

    /// All pairs of the scene that touch or overlap.
    pub fn collisions(&self) -> Vec<CollisionEntry> {
        let touching = |id: &PairId| {
            let pair = self.scene.pairs()[id.at()];
            let ask = DistanceQuery::exact(0.0);
            let distance = pair_clearance(self.scene, *id, &self.X_WJ, ask, &mut DVec3::ZERO.clone());
            // Compared so that what is not a number collides.
            let is_apart = distance > 0.0 && !contained(self.scene, *id, &self.X_WJ);
            (!is_apart).then_some([pair.first, pair.second])
        };
        let pairs = (0..self.scene.pairs().len() as u32).map(PairId);
        let told = |shapes: [ShapeIndex; 2]| {
            let [a, b] = shapes.map(|shape| self.robot.shapes[shape.at()].name.as_str());
            let entry = self.collision(shapes, format!("{a} and {b} collide"))?;
            let deep = entry.depth.map_or_else(String::new, |depth| format!(" ({:.2} mm deep)", depth * 1e3));
            Some(CollisionEntry { words: entry.words.clone() + &deep, ..entry })
        };
        pairs.filter_map(|id| touching(&id)).filter_map(told).collect()
    }

    /// Adds why the configuration can be no start or goal.
    pub fn tell(&self, why: &Infeasibility, document: &mut Document) {
        match why {
            Infeasibility::Collision(pairs) => {
                let told = |pair: &CollidingPair| self.collision([pair.shapes.0, pair.shapes.1], pair.to_string());
                let told: Vec<CollisionEntry> = pairs.iter().filter_map(told).collect();
                if told.is_empty() {
                    document.warnings.push(self.undecided());
                }
                document.collisions.extend(told);
            }
            other => document.violations.extend(Violation::all(other).iter().map(|of| self.violation(of))),
        }
    }

    /// What is said where only placeholders collide.
    fn undecided(&self) -> String {
        let what = match self.at {
            WhereEntry::Named(name) => format!("the {name}"),
            WhereEntry::Numbers(_) => "a goal".to_owned(),
        };
        format!("whether {what} is feasible is not decided: a mesh is missing, and only the box in its place collides")
    }

    /// An entry of what keeps the configuration from being a start or goal.
    pub fn violation(&self, of: &Violation<'_>) -> ViolationEntry {
        let words = match self.at {
            WhereEntry::Named(name) => format!("the {name} is infeasible: {}", of.words),
            WhereEntry::Numbers(_) => of.words.clone(),
        };
        let joint = of.coordinate.and_then(|coordinate| {
            let name = coordinate.rsplit_once(" of ").map_or(coordinate, |(_, name)| name);
            self.robot.joint(name).map(|joint| joint.at())
        });
        // A bound of a joint is seen at what the joint moves.
        let moved = |joint: usize| self.robot.links.iter().position(|link| link.joint.is_some_and(|j| j.at() == joint));
        let links = joint.and_then(moved).map(|link| vec![link]);
        let Violation { value, limit, .. } = *of;
        let entry = ViolationEntry {
            configuration: self.at.clone(),
            words,
            value,
            limit,
            joint,
            links,
            points: None,
            angle: None,
        };
        match &of.misplaced {
            Some(misplaced) => self.misplaced(misplaced, entry),
            None => entry,
        }
    }

    /// The entry with the links of a misplaced object, and the way to where it would have to be.
    fn misplaced(&self, of: &Misplaced<'_>, entry: ViolationEntry) -> ViolationEntry {
        let Some(part) = self.robot.parts.iter().find(|part| part.name == of.object) else { return entry };
        let link = &self.robot.links[part.root_link.at()];
        let X_WL = link.joint.map_or(Pose::identity(), |joint| self.X_WJ[joint.at()]) * link.joint_from_link;
        ViolationEntry {
            links: Some(part.links.clone().collect()),
            points: Some([X_WL.translation.to_array(), of.pose.translation.to_array()]),
            angle: Some(of.angle),
            ..entry
        }
    }
}

/// An object that no state has where it is.
pub(crate) struct Misplaced<'a> {
    /// The name of its part.
    pub object: &'a str,
    /// The pose of its root link in the world in the nearest state.
    pub pose: Pose,
    /// By which angle it would have to be turned, radians.
    pub angle: f64,
}

/// Something that is wrong at a configuration, other than a collision.
pub(crate) struct Violation<'a> {
    pub words: String,
    pub value: Option<f64>,
    pub limit: Option<f64>,
    /// The coordinate that it is about, as messages name it.
    pub coordinate: Option<&'a str>,
    /// The object that it is about, where it is about one that is elsewhere.
    pub misplaced: Option<Misplaced<'a>>,
}

impl<'a> Violation<'a> {
    /// What is wrong; where several things would have to be moved, each of the others in an entry of its own.
    fn all(why: &'a Infeasibility) -> Vec<Self> {
        let whole = Self::of(why);
        let Infeasibility::NoState { nearest: Some(nearest), .. } = why else { return vec![whole] };
        let mut corrections = nearest.corrections.iter();
        let first = corrections.next().map(Self::of_correction);
        let whole = match first {
            Some(first) => Self { coordinate: first.coordinate, misplaced: first.misplaced, ..whole },
            None => whole,
        };
        std::iter::once(whole).chain(corrections.map(Self::of_correction)).collect()
    }

    /// What would have to be moved.
    fn of_correction(correction: &'a Correction) -> Self {
        let name = &correction.name;
        let (coordinate, misplaced) = match correction.moved {
            Moved::Object(_, pose) => (None, Some(Misplaced { object: name, pose, angle: correction.angle })),
            _ => (Some(name.as_str()), None),
        };
        Self { words: correction.to_words(), value: None, limit: None, coordinate, misplaced }
    }

    fn of(why: &'a Infeasibility) -> Self {
        let (value, limit, coordinate) = match why {
            Infeasibility::OutOfBounds { coordinate, value, bounds: (low, high), .. } => {
                (Some(*value), Some(if value < low { *low } else { *high }), Some(coordinate))
            }
            Infeasibility::Locked { coordinate, value, locked_at } => {
                (Some(*value), Some(*locked_at), Some(coordinate))
            }
            Infeasibility::NotFinite { coordinate } => (None, None, Some(coordinate)),
            Infeasibility::NoState { nearest: Some(nearest), .. } => (Some(nearest.residual), None, None),
            _ => (None, None, None),
        };
        Self { words: why.to_string(), value, limit, coordinate: coordinate.map(String::as_str), misplaced: None }
    }
}
