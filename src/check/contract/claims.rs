//! What a file says of the problem once, against the scene: documents, limits, pairs, margins, locked joints.

use super::parts::same_pose;
use crate::check::contract::scene_contract::{Contract, differs};
use crate::check::motion::curve::Cubic;
use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::kind::Kind;
use crate::check::world::models::{corners, ordered};
use crate::path_file::document::{PathFile, RestsRule, SegmentEntry, SurfaceEntry};
use foliate_components::Pose;
use foliate_components::constraint::Rests;
use foliate_components::pose::pose_from_array;
use foliate_components::robot::{JointType, LinkIndex, Source, Surface};
use std::collections::{HashMap, HashSet};

/// Rounding of limits, margins and values, radians or metres.
const SLACK: f64 = 1e-9;

impl Contract<'_> {
    fn link(&self, link: LinkIndex) -> &str {
        &self.problem.robot.links[link.at()].name
    }

    /// Grippers, handles and surfaces are the scene's, all of them.
    pub(super) fn documents(&self, file: &PathFile, report: &mut CheckReport) {
        let (robot, documents) = (&self.problem.robot, &file.documents);
        let same = |row: [f64; 7], pose: &Pose| pose_from_array(row).is_some_and(|found| same_pose(&found, pose));
        let mut wrong = Vec::new();
        for known in &robot.grippers {
            let fits = documents.grippers.get(&known.name).is_some_and(|e| {
                e.link == self.link(known.link) && same(e.link_from_gripper, &known.link_from_gripper)
            });
            wrong.extend((!fits).then(|| format!("gripper `{}` is not the scene's", known.name)));
        }
        for known in &robot.handles {
            let fits = documents.handles.get(&known.name).is_some_and(|e| {
                e.link == self.link(known.link)
                    && same(e.link_from_handle, &known.link_from_handle)
                    && (e.mask, e.mask_complement) == (known.mask, known.mask_complement)
            });
            wrong.extend((!fits).then(|| format!("handle `{}` is not the scene's", known.name)));
        }
        for known in &robot.surfaces {
            let fits = documents
                .surfaces
                .get(&known.name)
                .is_some_and(|entry| entry.link == self.link(known.link) && same_polygons(entry, known));
            wrong.extend((!fits).then(|| format!("surface `{}` is not the scene's", known.name)));
        }
        let grippers = documents.grippers.keys().filter(|name| robot.gripper(name).is_none());
        let handles = documents.handles.keys().filter(|name| robot.handle(name).is_none());
        let surfaces = documents.surfaces.keys().filter(|name| robot.surface(name).is_none());
        let unknown = grippers.chain(handles).chain(surfaces);
        wrong.extend(unknown.map(|name| format!("the scene has no document `{}`", shown(name))));
        wrong.into_iter().for_each(|subject| differs(report, subject));
    }

    /// The file's limits are not wider than the scene's, and the knots keep the scene's.
    pub(super) fn limits(&self, file: &PathFile, report: &mut CheckReport) {
        let space = &self.problem.robot.space;
        let columns = self.columns(file);
        for (index, name) in self.names.iter().enumerate() {
            let Some(column) = columns[index] else {
                differs(report, format!("coordinate `{name}` of the scene is not in the file"));
                continue;
            };
            let (low, high) = (space.lower[index], space.upper[index]);
            match file.limits.get(name) {
                // Files write limits that have both ends.
                None if low.is_finite() && high.is_finite() => {
                    differs(report, format!("limits of `{name}` are not in the file: the scene has [{low}, {high}]"));
                }
                Some([l, h]) if *l < low - SLACK || *h > high + SLACK => {
                    differs(
                        report,
                        format!("limits of `{name}` are [{l}, {h}], wider than the scene's [{low}, {high}]"),
                    );
                }
                Some([l, h]) if *l > low + SLACK || *h < high - SLACK => {
                    report.note(format!("limits of {name} are [{l}, {h}], narrower than the scene's [{low}, {high}]"));
                }
                _ => {}
            }
            if self.is_root_of_object(index) {
                continue; // kept where it rests, by the file's limits
            }
            // Numbers of quaternions are scaled between knots; the file's limits of them, no wider, are proved there.
            let is_scaled = self.is_of_quaternion(index);
            for (segment, entry) in file.segments.iter().enumerate() {
                let beyond = |(_, (least, most)): &(usize, (f64, f64))| *least < low - SLACK || *most > high + SLACK;
                let at_knots = || entry.knots.iter().map(|row| (row[column], row[column])).enumerate().find(beyond);
                let found = if is_scaled { at_knots() } else { ranges(entry, column).find(beyond) };
                if let Some((knot, (least, most))) = found {
                    let (value, limit) = if least < low - SLACK { (least, low) } else { (most, high) };
                    let place = Place::at(segment, knot as f64);
                    report.violate(place, Kind::Limit, format!("{name}: the scene's limit"), value, limit);
                }
            }
        }
    }

    fn is_of_quaternion(&self, coordinate: usize) -> bool {
        self.problem.robot.joints.iter().any(|joint| match (joint.motion, joint.source) {
            (JointType::FreeFlyer, Source::Coordinates { q, .. }) => (q + 3..q + 7).contains(&coordinate),
            _ => false,
        })
    }

    /// Whether a coordinate is one of an object's free root, whose bounds count where it rests.
    fn is_root_of_object(&self, coordinate: usize) -> bool {
        let robot = &self.problem.robot;
        robot.parts.iter().filter_map(|part| part.root_joint.map(|joint| (part, joint))).any(|(part, joint)| {
            let joint = &robot.joints[joint.at()];
            let Source::Coordinates { q, .. } = joint.source else { return false };
            let mine = (q..q + joint.motion.configuration_size()).contains(&coordinate);
            mine && part.kind == foliate_components::robot::PartKind::Object
        })
    }

    /// The file ignores no pair that the scene tests, and no margin is smaller than the scene's.
    pub(super) fn pairs(&self, file: &PathFile, report: &mut CheckReport) {
        let pair = |first, second| ordered(self.link(first), self.link(second));
        let ignored: HashSet<_> = self.problem.ignored_pairs.iter().map(|p| pair(p.first, p.second)).collect();
        for [first, second, reason] in &file.ignored_pairs {
            if !ignored.contains(&ordered(first, second)) {
                let (first, second, reason) = (shown(first), shown(second), shown(reason));
                differs(report, format!("{first} and {second} are ignored ({reason}), the scene tests them"));
            }
        }
        let mut margins: HashMap<(String, String), f64> = HashMap::new();
        for (first, second, margin) in &file.margins {
            let known = margins.entry(ordered(first, second)).or_insert(0.0);
            *known = known.max(*margin);
        }
        for margin in &self.problem.margins {
            let (first, second) = pair(margin.first, margin.second);
            let said = margins.get(&(first.clone(), second.clone())).copied().unwrap_or(0.0);
            let kept = said >= margin.distance - SLACK;
            if !kept {
                differs(report, format!("margin of {first} and {second} is {said}, in the scene {}", margin.distance));
            }
        }
        let (said, margin) = (file.placement_margin, self.problem.graph.placement_margin);
        if (said - margin).abs() > SLACK {
            differs(report, format!("placement_margin is {said}, in the scene {margin}"));
        }
        let said = file.rests.map(|rests| (rests.rule, rests.margin));
        let wanted = match self.problem.graph.rests {
            Rests::Centre => None,
            Rests::Stable { margin } => Some((RestsRule::Stable, margin)),
            Rests::WholeFace { margin } => Some((RestsRule::WholeFace, margin)),
        };
        let same = said.map(|(rule, _)| rule) == wanted.map(|(rule, _)| rule)
            && said.zip(wanted).is_none_or(|((_, said), (_, margin))| (said - margin).abs() <= SLACK);
        if !same {
            differs(report, format!("objects rest by {said:?}, in the scene by {wanted:?} (rule and margin)"));
        }
    }

    /// Locked joints stand at their values all along.
    pub(super) fn locked(&self, file: &PathFile, report: &mut CheckReport) {
        let columns = self.columns(file);
        for (joint, value) in &self.problem.graph.locked {
            let joint = &self.problem.robot.joints[joint.at()];
            let Source::Coordinates { q, .. } = joint.source else { continue };
            let Some(column) = columns[q] else { continue };
            for (segment, entry) in file.segments.iter().enumerate() {
                let off = |(_, (least, most)): &(usize, (f64, f64))| value - least > SLACK || most - value > SLACK;
                if let Some((knot, (least, most))) = ranges(entry, column).find(off) {
                    let place = Place::at(segment, knot as f64);
                    let subject = format!("{} is locked", joint.name);
                    let found = if value - least > most - value { least } else { most };
                    report.violate(place, Kind::Demand, subject, found, *value);
                }
            }
        }
    }
}

/// The least and the greatest value of a column from each knot to the next.
fn ranges(segment: &SegmentEntry, column: usize) -> impl Iterator<Item = (usize, (f64, f64))> {
    (0..(segment.knots.len() - 1).max(1)).map(move |knot| (knot, Cubic::of(segment, column, knot).range()))
}

fn same_polygons(entry: &SurfaceEntry, known: &Surface) -> bool {
    entry.polygons.len() == known.polygons.len()
        && entry.polygons.iter().zip(&known.polygons).all(|(ours, theirs)| {
            let theirs: Vec<_> = theirs.iter().filter_map(|&i| known.points.get(i as usize)).collect();
            let ours = corners(entry, ours);
            ours.len() == theirs.len() && ours.iter().zip(theirs).all(|(a, b)| (*a - *b).abs().max_element() <= SLACK)
        })
}
