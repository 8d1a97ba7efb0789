//! Where a projected leg ends: whether it lies in the next state, and on which leaf of it.
//!
//! An object that is set down is moved exactly to where its new leaf has it, with all that it carries.

use crate::planning_model::attachments::parameter_in;
use crate::planning_model::graph::transitions::led_to;
use crate::planning_model::state_classification::{parameter_of, residual};
use crate::step::projection::project::{Context, Lane};
use foliate_components::Pose;
use foliate_components::candidate::LegParameter;
use foliate_components::graph::leaf::{Parameter, ParameterId};
use foliate_components::graph::{ConstraintId, ConstraintKind, Leg, StateId};
use foliate_kernels::kinematics::RigidAttachment;

impl Context<'_> {
    /// Whether a lane's configuration, which lies in `state`, lies in `next` too: what `next` requires beyond `state` holds
    /// to within the tolerance of a projection.
    pub(crate) fn lies_in(&self, next: StateId, state: StateId, lane: &Lane<'_>, X_WJ: &mut [Pose]) -> bool {
        let here = &self.model.graph.state(state).manifold;
        let more = self.model.graph.state(next).manifold.iter().filter(|&c| !here.contains(c));
        let more: Vec<ConstraintId> = more.copied().collect();
        if more.is_empty() {
            return true;
        }
        self.model.kinematics.forward(&lane.q, X_WJ);
        // A projection's tolerance bounds what it measured; measured again it may round differently.
        let tolerance = 2.0 * self.settings.projection_tolerance;
        more.iter().all(|&c| residual(self.model, c, &lane.q, X_WJ) <= tolerance)
    }

    /// The values of the foliating constraints of `next` at the end of a leg in `state`. Where they are new, a released
    /// object is put exactly where its new leaf has it; one that is picked up stays where it was.
    pub(crate) fn arrive(
        &self,
        state: StateId,
        next: StateId,
        lane: &Lane<'_>,
        end: &mut [f64],
        X_WJ: &mut [Pose],
    ) -> Vec<LegParameter> {
        if state == next {
            return lane.parameters.clone();
        }
        let here = &self.model.graph.state(state).foliation;
        let there = &self.model.graph.state(next).foliation;
        let mut set_down = Vec::new();
        self.model.kinematics.forward(end, X_WJ);
        let mut value = |constraint: &ConstraintId| {
            if let Some(position) = here.iter().position(|c| c == constraint) {
                return lane.parameters[position];
            }
            set_down.extend(self.resting_object(*constraint));
            match self.drawn_parameter(lane, *constraint) {
                Some(id) => LegParameter::Known(id),
                None => LegParameter::Fresh(self.exact_parameter(*constraint, end, X_WJ)),
            }
        };
        let parameters: Vec<_> = there.iter().map(&mut value).collect();
        if !set_down.is_empty() {
            self.put_down(next, &parameters, &set_down, end, X_WJ);
        }
        parameters
    }

    /// The drawn value of a constraint that the lane's transition adds.
    fn drawn_parameter(&self, lane: &Lane<'_>, constraint: ConstraintId) -> Option<ParameterId> {
        let leaf = self.leaves.leaf(lane.candidate.drawn?);
        let aims = |leg: &Leg| {
            let leads = |&c: &ConstraintId| {
                led_to(self.model.graph.constraint(c).kind) == self.model.graph.constraint(constraint).kind
            };
            leg.drawn.iter().any(leads)
        };
        let transition = self.model.graph.transition(lane.candidate.transition?);
        let position = self.model.graph.state(leaf.state).foliation.iter().position(|&c| c == constraint)?;
        transition.legs.iter().any(aims).then(|| leaf.parameters[position])
    }

    /// Moves objects exactly to where their leaf has them, and with them what they carry.
    fn put_down(
        &self,
        state: StateId,
        parameters: &[LegParameter],
        objects: &[usize],
        end: &mut [f64],
        X_WJ: &mut [Pose],
    ) {
        let kinematics = &self.model.kinematics;
        let all = self.model.rigid_attachments(state, |c| parameter_in(self.model, self.leaves, state, parameters, c));
        let mut moved: Vec<RigidAttachment> = Vec::new();
        let joints = &self.model.problem.robot.joints;
        for rigid_attachment in all {
            let own = self.model.objects().iter().position(|o| o.root == Some(rigid_attachment.object));
            let rides = |m: &RigidAttachment| {
                rigid_attachment.carrier.is_some_and(|body| joints[body.at()].part == joints[m.object.at()].part)
            };
            if own.is_some_and(|own| objects.contains(&own)) || moved.iter().any(rides) {
                moved.push(rigid_attachment);
            }
        }
        kinematics.forward(end, X_WJ);
        kinematics.carry(end, &moved, X_WJ);
        kinematics.write_back(&moved, X_WJ, end);
    }

    fn resting_object(&self, constraint: ConstraintId) -> Option<usize> {
        match self.model.graph.constraint(constraint).kind {
            ConstraintKind::Placement { object, .. } | ConstraintKind::Rest { object } => Some(object as usize),
            _ => None,
        }
    }

    /// The parameter of a constraint that a projection has just satisfied to within its tolerance, made exact: a placed
    /// object lies flat on its support, the margin above it.
    fn exact_parameter(&self, constraint: ConstraintId, q: &[f64], X_WJ: &[Pose]) -> Parameter {
        let mut found = parameter_of(self.model, constraint, q, X_WJ);
        if let ConstraintKind::Placement { object, on } = self.model.graph.constraint(constraint).kind
            && let object = &self.model.objects()[object as usize]
            && let (Some(root), Some(place)) = (object.root, object.placement_on(on))
            && let Some(exact) = place.resting.exact(root, X_WJ)
        {
            (found.carrier, found.value) = exact;
        }
        found
    }
}
