//! Proves every attachment and every listed constraint of a segment.

use crate::check::leaf::constraint;
use crate::check::leaf::on_leaf::Leaf;
use crate::check::motion::reach::Reach;
use crate::check::motion::segment::SegmentMotion;
use crate::check::report::check_report::CheckReport;
use crate::check::report::error::CheckError;
use crate::check::report::work::Work;
use crate::check::world::attachments::{Attachment, Bond};
use crate::check::world::documents::Frames;
use crate::path_file::document::PathFile;

pub(crate) fn check(
    motion: &SegmentMotion<'_>,
    file: &PathFile,
    frames: &Frames,
    attachments: &[Attachment],
    report: &mut CheckReport,
    work: &mut Work,
) -> Result<(), CheckError> {
    let entry = &file.segments[motion.index];
    if attachments.iter().all(|a| a.held.is_none()) && entry.constraints.is_empty() {
        return Ok(());
    }
    let reach = Reach::new(motion);
    let mut leaf = Leaf { motion, file, reach: &reach, report, work };
    for attachment in attachments {
        match &attachment.held {
            Some((.., Bond::Grasp { gripper, handle, mask, complement })) => {
                leaf.grasp(&attachment.name, gripper, handle, *mask, *complement);
            }
            Some((holder, held, Bond::Contact { surface, support })) => {
                let documents = &file.documents.surfaces;
                if let (Some(surface), Some(support)) = (documents.get(surface), documents.get(support)) {
                    leaf.contact(&attachment.name, (&holder.frame, support), (held, surface));
                }
            }
            Some((holder, held, Bond::Rest)) => {
                leaf.stands(attachment, holder);
                leaf.says_how(attachment);
                leaf.rest(&attachment.name, &holder.frame, &held.frame);
            }
            None => {}
        }
    }
    for (number, constraint) in entry.constraints.iter().enumerate() {
        let place = format!("segments[{}].constraints[{number}]", motion.index);
        constraint::check(&mut leaf, constraint, frames, &place)?;
    }
    Ok(())
}
