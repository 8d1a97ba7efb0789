//! A leaf as a local planner sees it: configurations are projected onto it, motions are kept on it and certified.

use crate::planning_model::model::PlanningModel;
use crate::settings::SearchSettings;
use crate::step::steering::{self, Steered};
use crate::step::validation;
use foliate_components::Pose;
use foliate_components::candidate::{LegParameter, PlannedLeg};
use foliate_components::graph::leaf::{LeafId, LeafIndex};
use foliate_components::graph::{StateId, TransitionId};
use foliate_components::outcome::Rejection;
use foliate_components::robot::ShapeIndex;
use foliate_kernels::collision::{CollisionScratch, PairId, PairSet, TestOrder, Verdicts};
use foliate_kernels::constrained_motion::{
    MotionScratch, Scratch as NewtonScratch, Settings as NewtonSettings, project,
};
use foliate_kernels::kinematics::RigidAttachment;

/// Configurations of a straight motion that are tested before it is certified. They find most collisions at about a tenth of the
/// cost of locating one by a certificate.
const SAMPLES: usize = 16;

/// So many projected knots cost as much as a straight motion.
const KNOTS_PER_WORK: u64 = 4;

/// A leaf of a state whose constraints compile.
pub struct LeafSpace<'a> {
    pub(super) model: &'a PlanningModel,
    settings: &'a SearchSettings,
    /// The loop of the leaf's state.
    pub(super) transition: TransitionId,
    pub(super) leaf: LeafId,
    state: StateId,
    /// Right-hand sides of projections.
    arguments: Vec<Pose>,
    /// Right-hand sides of motions.
    along: Vec<Pose>,
    /// Whether implicit rows keep motions on the leaf.
    is_implicit: bool,
    rigid_attachments: Vec<RigidAttachment>,
    pairs: &'a PairSet,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
pub struct LeafScratch {
    collision: CollisionScratch,
    motion: MotionScratch,
    newton: NewtonScratch,
    samples: Vec<f64>,
    /// Of the plan that grows.
    pub(super) order: TestOrder,
    /// Work that was done: straight motions, and as many knots as cost as much as one.
    pub(super) work: u64,
    /// What became of the motions.
    pub(super) attempts: Vec<MotionAttempt>,
    /// Where the motion that was tried last was found blocked, where the search keeps a log.
    blocked_at: Option<Box<[f64]>>,
    pub(super) X_WJ: Vec<Pose>,
}

/// What became of a motion that was tried, for statistics.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionAttempt {
    /// Why it does not arrive.
    pub rejected: Option<Rejection>,
    /// Whether a part of it is certified.
    pub is_kept: bool,
    /// The pair of shapes that stopped it, if one did.
    pub blocked_by: Option<(ShapeIndex, ShapeIndex)>,
    /// The configuration at which that pair was found too close, where the search keeps a log.
    pub blocked_at: Option<Box<[f64]>>,
}

/// A certified motion from a configuration towards another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Extension {
    /// Whole configurations, end to end; at least two.
    pub knots: Vec<f64>,
    /// Proven lower bound of the clearance beyond the margins, metres.
    pub clearance: f64,
    /// Proven bound of the residual of implicit rows, metres and radians.
    pub residual: f64,
    /// Whether it reaches the other configuration.
    pub arrives: bool,
    /// The pair of shapes that is in the way where it ends, if one is.
    pub blocked_by: Option<PairId>,
}

impl Extension {
    /// Where it ends.
    #[must_use]
    pub fn end(&self, size: usize) -> &[f64] {
        &self.knots[self.knots.len() - size..]
    }
}

/// Why nothing of a motion is certified.
enum Stopped {
    /// It cannot be kept on the leaf.
    Steering,
    /// Something is in the way.
    Blocked(Option<(ShapeIndex, ShapeIndex)>),
}

impl<'a> LeafSpace<'a> {
    /// `None` where the state has no motion within its leaves, or a constraint of it does not compile.
    #[must_use]
    pub fn new(
        model: &'a PlanningModel,
        settings: &'a SearchSettings,
        leaves: &'a LeafIndex,
        leaf: LeafId,
    ) -> Option<Self> {
        let of_leaf = leaves.leaf(leaf);
        let state = of_leaf.state;
        let transition = model.graph.loop_of(state)?;
        let parameters: Vec<_> = of_leaf.parameters.iter().map(|&p| LegParameter::Known(p)).collect();
        let program = model.leg_program(transition, 0).ok()?;
        let arguments = program.arguments(model, leaves, state, &parameters, None);
        let along = steering::arguments_on(model, of_leaf, leaves)?;
        let is_implicit = model.interior_program(state).ok()?.program.rows() > 0;
        let rigid_attachments = model.attachments_of_leaf(of_leaf, leaves);
        let pairs = model.pairs(transition, state, &rigid_attachments);
        Some(Self { model, settings, transition, leaf, state, arguments, along, is_implicit, rigid_attachments, pairs })
    }

    /// Moves a configuration onto the leaf. Whether it could.
    pub fn project(&self, q: &mut [f64], scratch: &mut LeafScratch) -> bool {
        let Ok(program) = self.model.leg_program(self.transition, 0) else { return false };
        let settings = NewtonSettings {
            tolerance: self.settings.projection_tolerance,
            iterations: self.settings.projection_iterations,
            level: self.settings.level,
            ..NewtonSettings::default()
        };
        project(&program.program, q, &self.arguments, &settings, &mut scratch.newton).is_converged()
    }

    /// The weighted distance of two configurations, metres.
    #[must_use]
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.model.problem.robot.space.distance(a, b, &self.model.robot_weights)
    }

    /// The motion from one configuration of the leaf straight towards another one, as far as it is certified. `None` where that is
    /// nowhere.
    pub fn extend(&self, from: &[f64], to: &[f64], scratch: &mut LeafScratch) -> Option<Extension> {
        scratch.collision.set_level(self.settings.level);
        scratch.work += 1;
        scratch.blocked_at = None;
        let motion =
            if self.is_implicit { self.projected(from, to, scratch) } else { self.straight(from, to, scratch) };
        let is_out = |motion: &Extension| self.model.object_out_of_bounds(motion.end(from.len()));
        let (rejected, blocked_by) = match &motion {
            Ok(motion) if is_out(motion) => (Some(Rejection::OutOfBounds(0)), None),
            Ok(Extension { arrives: true, .. }) => (None, None),
            Ok(Extension { blocked_by: None, .. }) => (Some(Rejection::SteeringFailed(0)), None),
            Ok(Extension { blocked_by: Some(pair), .. }) => {
                (Some(Rejection::MotionBlocked(0)), Some(self.model.pair_shapes(*pair)))
            }
            Err(Stopped::Steering) => (Some(Rejection::SteeringFailed(0)), None),
            Err(Stopped::Blocked(pair)) => (Some(Rejection::MotionBlocked(0)), *pair),
        };
        let motion = motion.ok().filter(|_| rejected != Some(Rejection::OutOfBounds(0)));
        let blocked_at = scratch.blocked_at.take().filter(|_| blocked_by.is_some());
        scratch.attempts.push(MotionAttempt { rejected, is_kept: motion.is_some(), blocked_by, blocked_at });
        motion
    }

    /// Where nothing is implicit: up to one of the last samples that are free, if that is certified.
    fn straight(&self, from: &[f64], to: &[f64], scratch: &mut LeafScratch) -> Result<Extension, Stopped> {
        let (size, space) = (from.len(), &self.model.problem.robot.space);
        scratch.samples.resize((SAMPLES + 1) * size, 0.0);
        for (number, q) in scratch.samples.chunks_exact_mut(size).enumerate() {
            space.interpolate(from, to, number as f64 / SAMPLES as f64, q);
        }
        let verdicts = Verdicts {
            scene: &self.model.collision,
            kinematics: &self.model.kinematics,
            rigid_attachments: &self.rigid_attachments,
            pairs: self.pairs,
            guard: self.settings.clearance_guard,
        };
        let hit = verdicts.first_on_motion(&scratch.samples, &mut scratch.order, &mut scratch.collision);
        let sample = |place: usize, scratch: &LeafScratch| scratch.samples[(place + 1) * size..][..size].to_vec();
        if let Some((place, _)) = hit.filter(|_| self.settings.log) {
            let mut q = sample(place, scratch);
            self.carry(&mut q, scratch);
            scratch.blocked_at = Some(q.into());
        }
        let end = match hit {
            None => to.to_vec(),
            Some((0, pair)) => return Err(Stopped::Blocked(Some(self.model.pair_shapes(pair)))),
            Some((place, _)) => {
                // The last free one but one, where there are two: close to what is in the way certificates are dear and often fail.
                let mut end = sample(place.saturating_sub(2), scratch);
                self.carry(&mut end, scratch);
                end
            }
        };
        let (along, knots) = ((self.transition, self.state), [from, &end].concat());
        let certified = validation::certify_or_find(
            self.model,
            self.settings,
            along,
            &self.rigid_attachments,
            &knots,
            &mut scratch.collision,
        );
        let clearance = certified.map_err(|blocked| {
            scratch.blocked_at = blocked.at.map(|q| validation::carried(self.model, &self.rigid_attachments, q));
            Stopped::Blocked(blocked.contact.map(|contact| self.model.pair_shapes(contact.pair)))
        })?;
        let blocked_by = hit.map(|(_, pair)| pair);
        Ok(Extension { knots, clearance, residual: 0.0, arrives: hit.is_none(), blocked_by })
    }

    /// Where rows are implicit: a polyline on the leaf, up to where it leaves it or something is in the way.
    fn projected(&self, from: &[f64], to: &[f64], scratch: &mut LeafScratch) -> Result<Extension, Stopped> {
        let (model, settings, ends) = (self.model, self.settings, (from, to));
        let Steered { knots, residual, is_whole } =
            steering::steer(model, settings, self.state, &self.along, ends, &mut scratch.motion)
                .filter(|steered| steered.knots.len() > from.len())
                .ok_or(Stopped::Steering)?;
        scratch.work += (knots.len() / from.len()) as u64 / KNOTS_PER_WORK;
        let mut leg = PlannedLeg { leg: 0, state: self.state, parameters: Vec::new(), knots, clearance: 0.0, residual };
        let blocked = validation::certified_prefix(
            model,
            settings,
            self.pairs,
            &self.rigid_attachments,
            &mut leg,
            &mut scratch.collision,
        );
        let PlannedLeg { knots, clearance, residual, .. } = leg;
        let arrives = is_whole && blocked.is_none();
        let blocked_by = blocked.as_ref().and_then(|blocked| blocked.contact).map(|contact| contact.pair);
        let at = blocked.and_then(|blocked| blocked.at);
        scratch.blocked_at = at.map(|q| validation::carried(model, &self.rigid_attachments, q));
        if knots.len() <= from.len() {
            return Err(Stopped::Blocked(blocked_by.map(|pair| model.pair_shapes(pair))));
        }
        Ok(Extension { knots, clearance, residual, arrives, blocked_by })
    }

    /// Writes carried objects where their carriers take them; leaves the poses of the bodies in the scratch.
    pub(super) fn carry(&self, q: &mut [f64], scratch: &mut LeafScratch) {
        let kinematics = &self.model.kinematics;
        scratch.X_WJ.resize(kinematics.bodies(), Pose::identity());
        kinematics.forward(q, &mut scratch.X_WJ);
        kinematics.carry(q, &self.rigid_attachments, &mut scratch.X_WJ);
        kinematics.write_back(&self.rigid_attachments, &scratch.X_WJ, q);
    }
}
