//! Who holds what and what lies where, segment by segment, is what the scene allows.

use crate::check::contract::scene_contract::Contract;
use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::path_file::document::{AttachmentEntry, PathFile, SegmentEntry};
use foliate_components::path::fingers;
use foliate_components::problem::{ObjectOptions, Rule};
use foliate_components::robot::{GripperIndex, HandleIndex, JointIndex, PartKind, RootJoint};
use std::collections::HashSet;

/// Who holds what.
type Grasps = Vec<(GripperIndex, HandleIndex)>;

impl Contract<'_> {
    pub(in crate::check) fn holding(&self, file: &PathFile, report: &mut CheckReport) {
        for (index, segment) in file.segments.iter().enumerate() {
            let mut wrong = HashSet::new();
            let grasps = self.grasps(&segment.attachments, &mut wrong);
            if !self.rules_allow(&grasps) {
                wrong.insert("the scene's rules do not allow these grasps together".to_owned());
            }
            for entry in &segment.attachments {
                let part = entry.object.split('/').next().unwrap_or_default();
                let known = self.problem.robot.part(part);
                if !known.is_some_and(|part| self.problem.graph.objects.iter().any(|object| object.part == part)) {
                    wrong.insert(format!("`{}` is no object of the scene", shown(&entry.object)));
                }
            }
            for object in &self.problem.graph.objects {
                self.object(object, &segment.attachments, &mut wrong);
            }
            for (gripper, _) in grasps.iter().filter(|(gripper, _)| !self.holds_firmly(*gripper, file, segment)) {
                let gripper = shown(&self.problem.robot.grippers[gripper.at()].name);
                wrong.insert(format!("fingers of `{gripper}` move while it holds something and the robot moves"));
            }
            let mut wrong: Vec<_> = wrong.into_iter().collect();
            wrong.sort_unstable();
            let place = Place { segment: Some(index), t: None };
            wrong.into_iter().for_each(|subject| report.violate(place, Kind::Holding, subject, None, None));
        }
    }

    /// Whether the fingers of a gripper stand still along a segment, or nothing but fingers moves. Fingers that the scene plans as other
    /// joints, or of which it locks one, are no fingers here.
    fn holds_firmly(&self, gripper: GripperIndex, file: &PathFile, segment: &SegmentEntry) -> bool {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let joints = match options.hands.iter().find(|hand| hand.grippers.contains(&gripper)) {
            Some(hand) => hand.fingers.iter().map(|finger| finger.joint).collect(),
            None => fingers(robot, gripper),
        };
        if joints.iter().any(|joint| options.locked.iter().any(|(locked, _)| locked == joint)) {
            return true;
        }
        let first = &segment.knots[0];
        let moves = |column: usize| {
            segment.knots.iter().any(|knot| knot[column] != first[column])
                || segment.velocities.iter().flatten().any(|row| row[column] != 0.0)
        };
        let is_finger = |name: &str| joints.iter().any(|joint| robot.joints[joint.at()].name == name);
        let is_of_object = |name: &str| {
            let part = robot.part(name.split('/').next().unwrap_or_default());
            part.is_some_and(|part| robot.parts[part.at()].kind == PartKind::Object)
        };
        let moving: Vec<_> = (0..first.len()).filter(|&column| moves(column)).map(|c| &file.coordinates[c]).collect();
        let has_finger = moving.iter().any(|name| is_finger(name));
        !has_finger || moving.iter().all(|name| is_finger(name) || is_of_object(name))
    }

    fn grasps(&self, entries: &[AttachmentEntry], wrong: &mut HashSet<String>) -> Grasps {
        let (robot, options) = (&self.problem.robot, &self.problem.graph);
        let mut grasps = Grasps::new();
        for entry in entries {
            let (Some(gripper), Some(handle)) = (&entry.gripper, &entry.handle) else { continue };
            let found = robot.gripper(gripper).filter(|g| options.grippers.contains(g));
            let found =
                found.zip(robot.handle(handle).filter(|h| options.objects.iter().any(|o| o.handles.contains(h))));
            let allowed = found.filter(|grasp| options.grasps.as_ref().is_none_or(|table| table.contains(grasp)));
            match allowed {
                Some(grasp) => grasps.push(grasp),
                None => {
                    let (gripper, handle) = (shown(gripper), shown(handle));
                    wrong.insert(format!("`{gripper}` may not hold `{handle}` in this scene"));
                }
            }
        }
        grasps
    }

    /// The first rule that applies decides; once there are rules, grasps to which none applies are refused.
    fn rules_allow(&self, grasps: &Grasps) -> bool {
        let rules = &self.problem.graph.rules;
        let holds = |gripper: GripperIndex| grasps.iter().find(|(g, _)| *g == gripper).map(|(_, h)| *h);
        let applies = |rule: &&Rule| rule.grasps.iter().all(|&(gripper, handle)| holds(gripper) == handle);
        rules.iter().find(applies).map_or(rules.is_empty(), |rule| rule.allowed)
    }

    /// How one object is attached: in grippers, on a support, on its plane, or where it is.
    fn object(&self, object: &ObjectOptions, entries: &[AttachmentEntry], wrong: &mut HashSet<String>) {
        let part = &self.problem.robot.parts[object.part.at()];
        let name = &part.name;
        let mine: Vec<&AttachmentEntry> =
            entries.iter().filter(|e| e.object.split('/').next() == Some(name.as_str())).collect();
        let floats = part.kind == PartKind::Object && part.root == RootJoint::FreeFlyer;
        let held: Vec<_> = mine.iter().filter(|e| e.gripper.is_some()).collect();
        let by_root: Vec<_> = held.iter().filter(|e| self.is_on_root(object, e)).collect();
        let rigid = |entry: &&AttachmentEntry| self.is_on_root(object, entry) && self.is_rigid(entry);
        let carriers = held.iter().filter(|e| e.carrier).count();
        let wanted = usize::from(floats && held.iter().any(|e| rigid(e)));
        if carriers != wanted || held.iter().any(|e| e.carrier && !rigid(e)) {
            wrong.insert(format!("`{name}` follows {carriers} of the grippers that hold it, in the scene {wanted}"));
        }
        let lying: Vec<_> = mine.iter().filter(|e| e.gripper.is_none()).collect();
        if !floats || !by_root.is_empty() {
            if !lying.is_empty() {
                wrong.insert(format!("`{name}` is held, or fixed, and yet lies somewhere"));
            }
            return;
        }
        if lying.iter().any(|e| !e.carrier) {
            wrong.insert(format!("`{name}` does not follow what it lies on"));
        }
        let fits = match (&object.plane, object.surfaces.is_empty()) {
            (Some(plane), _) => {
                let on = plane.on.map(|link| self.problem.robot.links[link.at()].name.as_str());
                let said: Vec<_> = lying.iter().map(|e| e.on.as_deref()).collect();
                match on {
                    Some(on) => said == [Some(on)],
                    None => said.is_empty(),
                }
            }
            (None, true) => lying.is_empty(),
            (None, false) => lying.len() == 1 && lying.iter().all(|e| self.is_contact(object, e)),
        };
        if !fits {
            wrong.insert(format!("`{name}` does not lie where the scene allows it"));
        }
    }

    fn is_contact(&self, object: &ObjectOptions, entry: &AttachmentEntry) -> bool {
        let (Some(surface), Some(support)) = (&entry.surface, &entry.support) else { return false };
        let robot = &self.problem.robot;
        robot.surface(surface).is_some_and(|s| object.surfaces.contains(&s))
            && robot.surface(support).is_some_and(|s| self.problem.graph.supports.contains(&s))
    }

    /// Whether a grasp leaves nothing free that is not frozen.
    fn is_rigid(&self, entry: &AttachmentEntry) -> bool {
        let robot = &self.problem.robot;
        let handle = entry.handle.as_ref().and_then(|name| robot.handle(name)).map(|h| &robot.handles[h.at()]);
        handle.is_some_and(|handle| (0..6).all(|row| handle.mask[row] || handle.mask_complement[row]))
    }

    /// Whether a grasp's handle is on the object's root, joints that never move aside.
    fn is_on_root(&self, object: &ObjectOptions, entry: &AttachmentEntry) -> bool {
        let robot = &self.problem.robot;
        let Some(handle) = entry.handle.as_ref().and_then(|name| robot.handle(name)) else { return false };
        let mut joint = robot.links[robot.handles[handle.at()].link.at()].joint;
        let root = robot.parts[object.part.at()].root_joint;
        let still = |joint: JointIndex| {
            robot.joints[joint.at()].is_immovable()
                || self.problem.graph.locked.iter().any(|(locked, _)| *locked == joint)
        };
        while joint != root {
            match joint {
                Some(at) if still(at) => joint = robot.joints[at.at()].parent,
                _ => return false,
            }
        }
        root.is_some()
    }
}
