//! What states are called, and which constraints hold on the way to a grasp.

use crate::planning_model::graph::states::state_keys::{StateKey, StateKeys, handles};
use foliate_components::constraint::ApproachBound;
use foliate_components::graph::{ConstraintKind, Fingers, Opening};
use foliate_components::problem::Approach;
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex};

impl StateKeys<'_> {
    /// How far a hand is open beside what it is to grasp. Without a pregrasp there is no place beside the object at which it could open.
    pub(in crate::planning_model::graph) fn beside(&self, gripper: GripperIndex, handle: HandleIndex) -> Opening {
        match self.options.approach {
            Approach::AsNeeded { .. } if self.has_pregrasp(gripper, handle) => Opening::Ready { gripper, handle },
            _ => Opening::Wide,
        }
    }

    /// Whether a gripper has to go to a handle along a line.
    pub(in crate::planning_model::graph) fn has_line(&self, gripper: GripperIndex, handle: HandleIndex) -> bool {
        let grasp = self.documents.grasps.get(&(gripper, handle));
        self.options.line_to(gripper, handle).is_some() && grasp.is_some_and(|grasp| grasp.has_line())
    }

    /// What holds on that line.
    pub(in crate::planning_model::graph) fn on_line(
        &self,
        gripper: GripperIndex,
        handle: HandleIndex,
    ) -> Vec<ConstraintKind> {
        let turns_freely = self.documents.grasps.get(&(gripper, handle)).is_some_and(|grasp| !grasp.mask.0[3]);
        let bounds = [ApproachBound::Line, ApproachBound::Aim, ApproachBound::Roll];
        let bounds = bounds.into_iter().filter(|bound| *bound != ApproachBound::Roll || !turns_freely);
        bounds.map(|bound| ConstraintKind::Approach { gripper, handle, bound }).collect()
    }

    pub(super) fn object_name(&self, object: usize) -> &str {
        &self.robot.parts[self.options.objects[object].part.at()].name
    }

    /// What a body that moves is called: its part, or its link where the part has several.
    pub(super) fn body_name(&self, body: JointIndex) -> &str {
        let part = &self.robot.parts[self.robot.joints[body.at()].part.at()];
        let link = part.links.clone().find(|&l| self.robot.links[l].joint == Some(body));
        match link {
            Some(link) if part.root_joint != Some(body) => &self.robot.links[link].name,
            _ => &part.name,
        }
    }

    pub fn state_name(&self, key: &StateKey) -> String {
        let grasp = |&(g, h): &(GripperIndex, HandleIndex)| {
            format!("{} grasps {}", self.robot.grippers[g.at()].name, self.robot.handles[h.at()].name)
        };
        let written = self.options.states.get(key.written).map(|state| state.name.clone());
        let mut words: Vec<String> = written.into_iter().chain(key.grasps.iter().map(grasp)).collect();
        if words.is_empty() {
            words.push("free".into());
        }
        words.extend(self.lying_name(key, None));
        let gripper = |hand: u32| &self.robot.grippers[self.options.hands[hand as usize].grippers[0].at()].name;
        match key.fingers {
            Fingers::Still => {}
            Fingers::Free => words.push("fingers move".into()),
            Fingers::Moving(hand) => words.push(format!("{} moves its fingers", gripper(hand))),
            Fingers::Wide(hand) => words.push(format!("{} is wide open", gripper(hand))),
            Fingers::Ready { hand, handle, .. } => {
                words.push(format!("{} is open for {}", gripper(hand), self.robot.handles[handle.at()].name));
            }
            Fingers::OnLine { gripper, handle, .. } => {
                let [gripper, handle] =
                    [&self.robot.grippers[gripper.at()].name, &self.robot.handles[handle.at()].name];
                words.push(format!("{gripper} is on the line to {handle}"));
            }
            Fingers::Lifting { object, on } => {
                let object = self.object_name(object as usize);
                let off = on.map_or(String::new(), |body| format!(" off {}", self.body_name(body)));
                words.push(format!("{object} is lifted straight{off}"));
            }
        }
        words.join(" : ")
    }

    /// `lid on box` for every object that lies on a body which moves, and not in the other case.
    pub fn lying_name(&self, key: &StateKey, other: Option<&StateKey>) -> Vec<String> {
        let lies = |object: usize| {
            let body = key.lying[object].filter(|_| other.is_none_or(|other| other.lying[object] != key.lying[object]));
            body.map(|body| format!("{} on {}", self.object_name(object), self.body_name(body)))
        };
        (0..key.lying.len()).filter_map(lies).collect()
    }

    /// HPP's short names: `0-1:1-0` for gripper 0 on handle 1 and gripper 1 on handle 0, `f` for free.
    pub fn abbreviation(&self, key: &StateKey) -> String {
        let short = |&(gripper, handle): &(GripperIndex, HandleIndex)| {
            let g = self.options.grippers.iter().position(|&x| x == gripper).unwrap_or_default();
            let h = handles(self.options).position(|x| x == handle).unwrap_or_default();
            format!("{g}-{h}")
        };
        let grasps = key.grasps.iter().map(short).collect::<Vec<_>>().join(":");
        let written = self.options.states.get(key.written).map(|state| state.name.clone());
        let mut words: Vec<String> = written.into_iter().chain((!grasps.is_empty()).then_some(grasps)).collect();
        if words.is_empty() {
            words.push("f".into());
        }
        words.extend(self.lying_name(key, None));
        words.join(" : ")
    }
}
