//! A gripper goes to a handle along a line, and backs off along it, as the scene asks: the x axis of the handle, from the pregrasp to the grasp.
//! The segment before a grasp begins, and the one after it has ended, keep to it, and reach back as far as the pregrasp.

use crate::check::contract::scene_contract::Contract;
use crate::check::motion::segment::{At, SegmentMotion};
use crate::check::report::check_report::{CheckReport, Place};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::world::documents::Frames;
use crate::path_file::document::PathFile;
use foliate_components::constraint::{ApproachBound, Grasp};
use foliate_components::problem::{ApproachLine, NamedConstraint};

/// A grasp that begins after a segment, or has ended before it.
struct Approach<'f> {
    gripper: &'f str,
    handle: &'f str,
    /// By the scene.
    grasp: Grasp,
    line: ApproachLine,
    /// Whether it begins; otherwise it has ended.
    begins: bool,
}

impl Contract<'_> {
    /// What holds along a segment that leads to a grasp or back.
    pub(in crate::check::contract) fn on_lines(&self, file: &PathFile, segment: usize) -> Vec<NamedConstraint> {
        let bounds = |approach: &Approach<'_>| {
            let line = approach.line;
            let name = format!("the line from {} to {}", approach.gripper, approach.handle);
            let kinds = [ApproachBound::Line, ApproachBound::Aim, ApproachBound::Roll];
            let rows = kinds.map(|bound| approach.grasp.approach(bound, line.distance, line.angle));
            rows.into_iter().flatten().map(move |constraint| NamedConstraint { name: name.clone(), constraint })
        };
        self.approaches(file, segment).iter().flat_map(bounds).collect()
    }

    /// Whether a segment that leads to a grasp begins as far from it as the pregrasp, and one that leads back ends there.
    pub(in crate::check::contract) fn line_ends(
        &self,
        file: &PathFile,
        motion: &SegmentMotion<'_>,
        frames: &Frames,
        report: &mut CheckReport,
    ) -> Result<(), CheckError> {
        for Approach { gripper, handle, grasp, begins, .. } in self.approaches(file, motion.index) {
            let [of_gripper, of_handle] =
                [gripper, handle].map(|name| frames.named(motion.world, name, || "scene".into()));
            let (of_gripper, of_handle) = (of_gripper?, of_handle?);
            let at = At::knot(if begins { 0 } else { motion.last() });
            let ahead = motion.frame(&of_gripper, at).inverse() * motion.frame(&of_handle, at);
            let is_back = ahead.translation.x >= grasp.standoff - file.certificate.path_tolerance;
            if !is_back {
                let subject = format!("{gripper} is nearer to {handle} than the pregrasp where its line ends");
                report.violate(
                    Place::at(motion.index, at.t()),
                    Kind::Demand,
                    subject,
                    ahead.translation.x,
                    grasp.standoff,
                );
            }
        }
        Ok(())
    }

    /// The grasps that begin after a segment or have ended before it, and have a line.
    fn approaches<'f>(&self, file: &'f PathFile, segment: usize) -> Vec<Approach<'f>> {
        let here = grasps(file, Some(segment));
        let beside = |other: Option<usize>, begins: bool| {
            let others: Vec<_> = grasps(file, other).into_iter().filter(|grasp| !here.contains(grasp)).collect();
            others.into_iter().filter_map(move |(gripper, handle)| {
                let robot = &self.problem.robot;
                let named = (robot.gripper(gripper)?, robot.handle(handle)?);
                let line = self.problem.graph.line_to(named.0, named.1)?;
                let grasp = Grasp::new(robot, named.0, named.1).ok()?;
                grasp.has_line().then_some(Approach { gripper, handle, grasp, line, begins })
            })
        };
        beside(segment.checked_add(1), true).chain(beside(segment.checked_sub(1), false)).collect()
    }
}

/// Who holds what along a segment: gripper and handle. Nothing where there is no segment.
fn grasps(file: &PathFile, segment: Option<usize>) -> Vec<(&str, &str)> {
    let entries = segment.and_then(|segment| file.segments.get(segment)).map(|segment| &segment.attachments);
    let held = entries.into_iter().flatten();
    held.filter_map(|entry| Some((entry.gripper.as_deref()?, entry.handle.as_deref()?))).collect()
}
