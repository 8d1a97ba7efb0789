//! Draws where objects start and end.
#![allow(non_snake_case, reason = "pose names carry their frames")]

use crate::batch::vary::options::{Vary, Which};
use crate::batch::vary::rejections::{Rejection, Rejections};
use foliate_components::Pose;
use foliate_components::graph::StateId;
use foliate_components::infeasibility::Infeasibility;
use foliate_components::pose::pose_to_array;
use foliate_components::problem::Goal;
use foliate_components::robot::{PartIndex, PartKind, ShapeIndex, Source};
use foliate_systems::heuristic::placements::draw_place;
use foliate_systems::planning_model::PlanningModel;
use foliate_systems::planning_model::state_classification::{reach_feasible, reach_start, state_of};
use foliate_systems::settings::SearchSettings;
use glam::DVec3;
use rand::RngExt;

/// Draws of one object's place before all are drawn anew.
const DRAWS: usize = 64;
/// Draws of one place for one that has the face down that is asked for.
const FACES: usize = 64;
/// Cosine of the angle to which the direction of a face is the same.
const SAME_FACE: f64 = 0.999;

/// What was drawn.
pub(crate) struct Ends {
    pub start: Vec<f64>,
    pub goals: Vec<Goal>,
}

/// Draws starts and goals of one problem.
pub(crate) struct Places<'a> {
    pub model: &'a PlanningModel,
    pub settings: &'a SearchSettings,
    pub vary: &'a Vary,
}

/// One configuration whose objects are placed, one after another.
struct Placing<'a> {
    q: &'a mut [f64],
    /// A state whose margins count.
    state: StateId,
    /// What a collision is told as.
    collides: Rejection,
    /// Whether what robots touch counts: not where the goal leaves them free.
    with_robots: bool,
    /// Objects that have no place yet; they touch nothing.
    unplaced: Vec<PartIndex>,
}

impl Places<'_> {
    /// Objects (numbers of the graph) that are to be drawn: of all that lie on a fixed support in `q`, those that are asked for and that
    /// `may` says. Those asked for by name need not lie there.
    fn chosen(&self, which: &Which, q: &[f64], may: impl Fn(PartIndex) -> bool) -> Vec<usize> {
        let robot = &self.model.problem.robot;
        let X_WJ = self.model.kinematics.poses(q);
        let is_chosen = |(object, part): (usize, PartIndex)| {
            let is_asked = match which {
                Which::None => false,
                Which::All => self.rests(object, &X_WJ) == Some(true),
                Which::These(names) => names.contains(&robot[part].name),
            };
            (is_asked && may(part)).then_some(object)
        };
        let objects = self.model.graph.objects.iter().map(|object| object.part).enumerate();
        objects.filter_map(is_chosen).collect()
    }

    /// Whether an object lies on what is fixed in the world; `None` where it never does.
    fn rests(&self, object: usize, X_WJ: &[Pose]) -> Option<bool> {
        let place = self.model.objects()[object].placement_on(None)?;
        Some(place.resting.residual(0.0, X_WJ) <= self.settings.classification_tolerance)
    }

    /// A start and goals, or nothing where this draw gave none.
    pub(crate) fn draw(&self, rng: &mut impl RngExt, refused: &mut Rejections) -> Option<Ends> {
        let problem = &self.model.problem;
        let mut ends = Ends { start: problem.start.clone(), goals: problem.goals.clone() };
        let mut model = self.model.clone();
        let state = self.state_at(&mut model, &ends.start);
        let starts = self.chosen(&self.vary.starts, &ends.start, |_| true);
        if let (false, Some(state)) = (starts.is_empty(), state) {
            let placing = Placing {
                q: &mut ends.start,
                state,
                collides: Rejection::StartCollides,
                with_robots: true,
                unplaced: self.parts(&starts),
            };
            self.place(placing, &starts, rng, refused)?;
        }
        if let Err(why) = reach_start(&mut model, self.settings, &ends.start) {
            refused.add(reason(&why, Rejection::StartCollides, Rejection::Start));
            return None;
        }
        for goal in &mut ends.goals {
            self.draw_goal(goal, &ends.start, &mut model, rng, refused)?;
        }
        Some(ends)
    }

    fn parts(&self, objects: &[usize]) -> Vec<PartIndex> {
        objects.iter().map(|&object| self.model.graph.objects[object].part).collect()
    }

    fn state_at(&self, model: &mut PlanningModel, q: &[f64]) -> Option<StateId> {
        let tolerance = self.settings.classification_tolerance;
        model.reach(q, tolerance);
        state_of(model, q, &model.kinematics.poses(q), tolerance)
    }

    fn draw_goal(
        &self,
        goal: &mut Goal,
        start: &[f64],
        model: &mut PlanningModel,
        rng: &mut impl RngExt,
        refused: &mut Rejections,
    ) -> Option<()> {
        let state = self.state_at(model, start)?;
        let collides = Rejection::GoalCollides;
        match goal {
            Goal::Configuration(q) => {
                let objects = self.chosen(&self.vary.goals, q, |_| true);
                // What is not drawn anew stays where it starts, if it was to stay there.
                self.keep_still(q, start, &objects);
                let unplaced = self.parts(&objects);
                let state = self.state_at(model, q).unwrap_or(state);
                let placing = Placing { q, state, collides, with_robots: true, unplaced };
                self.place(placing, &objects, rng, refused)?;
                if let Err(why) = reach_feasible(model, self.settings, q) {
                    refused.add(reason(&why, Rejection::GoalCollides, Rejection::Goal));
                    return None;
                }
            }
            Goal::Partial(partial) => {
                let mut q = start.to_vec();
                self.model.place_objects(start, &partial.poses, &mut q);
                let has_pose = |part| partial.poses.iter().any(|(given, _)| *given == part);
                let objects = self.chosen(&self.vary.goals, &q, has_pose);
                let unplaced = self.parts(&objects);
                let placing = Placing { q: &mut q, state, collides, with_robots: false, unplaced };
                self.place(placing, &objects, rng, refused)?;
                let X_WJ = self.model.kinematics.poses(&q);
                for &object in &objects {
                    let part = self.model.graph.objects[object].part;
                    let root = self.model.objects()[object].root?;
                    let given = partial.poses.iter_mut().filter(|(given, _)| *given == part);
                    given.for_each(|(_, pose)| *pose = X_WJ[root.at()]);
                }
            }
        }
        Some(())
    }

    /// Objects that a whole goal leaves where they started, and that start elsewhere now, stay there.
    fn keep_still(&self, q: &mut [f64], start: &[f64], drawn: &[usize]) {
        let before = &self.model.problem.start;
        for (number, object) in self.model.objects().iter().enumerate() {
            let Some(first) = object.root.and_then(|root| self.coordinates(root.at())) else { continue };
            let numbers = first..first + 7;
            if !drawn.contains(&number) && q[numbers.clone()] == before[numbers.clone()] {
                q[numbers.clone()].copy_from_slice(&start[numbers]);
            }
        }
    }

    /// The first number of a joint.
    fn coordinates(&self, joint: usize) -> Option<usize> {
        match self.model.problem.robot.joints[joint].source {
            Source::Coordinates { q, .. } => Some(q),
            Source::Follows { .. } => None,
        }
    }

    /// Places objects one after another; nothing where one finds no place.
    fn place(
        &self,
        mut placing: Placing<'_>,
        objects: &[usize],
        rng: &mut impl RngExt,
        refused: &mut Rejections,
    ) -> Option<()> {
        let X_WJ = self.model.kinematics.poses(placing.q);
        let up = |object: usize| {
            let keeps_face = !self.vary.any_face && self.rests(object, &X_WJ) == Some(true);
            keeps_face.then(|| self.up(object, &X_WJ)).flatten()
        };
        let faces: Vec<Option<DVec3>> = objects.iter().map(|&object| up(object)).collect();
        for (&object, face) in objects.iter().zip(faces) {
            let part = self.model.graph.objects[object].part;
            placing.unplaced.retain(|unplaced| *unplaced != part);
            let is_placed = (0..DRAWS).any(|_| match self.try_place(&mut placing, (object, face), rng) {
                Ok(()) => true,
                Err(reason) => {
                    refused.add(reason);
                    false
                }
            });
            is_placed.then_some(())?;
        }
        Some(())
    }

    /// The normal of what carries an object, in the frame of its root: which face is down.
    fn up(&self, object: usize, X_WJ: &[Pose]) -> Option<DVec3> {
        let model = &self.model.objects()[object];
        let normal = model.placement_on(None)?.resting.normal(X_WJ);
        Some(X_WJ[model.root?.at()].rotation.conjugate() * normal)
    }

    /// A place with a face down, if one is asked for.
    fn draw_face(&self, q: &[f64], object: usize, face: Option<DVec3>, rng: &mut impl RngExt) -> Option<Pose> {
        let root = self.model.objects()[object].root?;
        let mut X_WJ = self.model.kinematics.poses(q);
        for _ in 0..FACES {
            let X_WO = draw_place(self.model, object as u32, rng)?;
            X_WJ[root.at()] = X_WO;
            let is_same = |up: DVec3| self.up(object, &X_WJ).is_some_and(|drawn| drawn.dot(up) > SAME_FACE);
            if face.is_none_or(is_same) {
                return Some(X_WO);
            }
        }
        None
    }

    fn try_place(
        &self,
        placing: &mut Placing<'_>,
        (object, face): (usize, Option<DVec3>),
        rng: &mut impl RngExt,
    ) -> Result<(), Rejection> {
        let X_WO = self.draw_face(placing.q, object, face, rng).ok_or(Rejection::Outside)?;
        let place = X_WO.translation.to_array();
        let mut bounds = place.iter().zip(self.vary.within);
        if !bounds.all(|(x, span)| span.is_none_or(|(low, high)| (low..=high).contains(x))) {
            return Err(Rejection::Outside);
        }
        let root = self.model.objects()[object].root.ok_or(Rejection::Outside)?;
        let first = self.coordinates(root.at()).ok_or(Rejection::Outside)?;
        placing.q[first..first + 7].copy_from_slice(&pose_to_array(&self.in_parent(root.at(), &X_WO)));
        let X_WJ = self.model.kinematics.poses(placing.q);
        if self.rests(object, &X_WJ) != Some(true) {
            return Err(Rejection::Unstable);
        }
        let part = self.model.graph.objects[object].part;
        if self.touches(placing, part, &X_WJ) { Err(placing.collides) } else { Ok(()) }
    }

    /// A pose in the world in the frame in which a joint's coordinates say it.
    fn in_parent(&self, joint: usize, X_WO: &Pose) -> Pose {
        self.model.problem.robot.joints[joint].parent_from_joint.inverse() * *X_WO
    }

    /// Whether an object touches anything that has its place.
    fn touches(&self, placing: &Placing<'_>, object: PartIndex, X_WJ: &[Pose]) -> bool {
        let robot = &self.model.problem.robot;
        let part = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].part;
        let counts = |other: PartIndex| {
            !placing.unplaced.contains(&other) && (placing.with_robots || robot[other].kind != PartKind::Robot)
        };
        let contacts = self.model.all_collisions(placing.state, X_WJ, self.settings.clearance_guard);
        contacts.iter().any(|contact| {
            let (first, second) = self.model.pair_shapes(contact.pair);
            let (first, second) = (part(first), part(second));
            (first == object && counts(second)) || (second == object && counts(first))
        })
    }
}

fn reason(why: &Infeasibility, collides: Rejection, other: Rejection) -> Rejection {
    if matches!(why, Infeasibility::Collision(_)) { collides } else { other }
}
