//! What objects are attached to in each segment, read from the file: grasps, contacts, a link that they rest on, or nothing but
//! their place.

use crate::check::report::check_report::shown;
use crate::check::report::error::CheckError;
use crate::check::world::documents::Frames;
use crate::check::world::models::{Frame, Link, World};
use crate::path_file::document::{AttachmentEntry, PathFile};
use std::collections::HashSet;

/// How an object is held.
#[derive(Clone, Debug)]
pub(crate) enum Bond {
    /// A gripper holds a handle.
    Grasp { gripper: Frame, handle: Frame, mask: [bool; 6], complement: [bool; 6] },
    /// A surface lies on a support; both by name.
    Contact { surface: String, support: String },
    /// The object rests on a link without polygons.
    Rest,
}

/// An attachment of a segment.
#[derive(Clone, Debug)]
pub(crate) struct Attachment {
    /// The object's part.
    pub part: usize,
    /// Whether the object follows it.
    pub carrier: bool,
    /// For people.
    pub name: String,
    /// Link that holds, link that is held, and how; none where the object just stays where it is.
    pub held: Option<(Link, Link, Bond)>,
}

impl Attachment {
    pub(crate) fn is_grasp(&self) -> bool {
        matches!(self.held, Some((.., Bond::Grasp { .. })))
    }
}

/// The attachments of every segment.
pub(crate) fn resolve(file: &PathFile, world: &World, frames: &Frames) -> Result<Vec<Vec<Attachment>>, CheckError> {
    let of_segment = |(index, segment): (usize, &crate::path_file::document::SegmentEntry)| {
        let entries = segment.attachments.iter().enumerate();
        let resolved: Result<Vec<_>, _> = entries
            .map(|(number, entry)| {
                let place = format!("segments[{index}].attachments[{number}]");
                Resolver { file, world, frames, place }.attachment(entry)
            })
            .collect();
        resolved.and_then(|list| one_carrier_each(world, index, list)).and_then(|list| {
            one_handle_each(index, &segment.attachments)?;
            Ok(list)
        })
    };
    file.segments.iter().enumerate().map(of_segment).collect()
}

fn one_carrier_each(world: &World, index: usize, list: Vec<Attachment>) -> Result<Vec<Attachment>, CheckError> {
    for (part, entry) in world.parts.iter().enumerate().filter(|(_, p)| p.floats) {
        let carriers = list.iter().filter(|a| a.carrier && a.part == part).count();
        if carriers > 1 {
            let message = format!("`{}` has {carriers} carriers", shown(&entry.name));
            return Err(CheckError::malformed(format!("segments[{index}].attachments"), message));
        }
    }
    Ok(list)
}

/// A gripper holds one handle at a time, and a handle is in one gripper.
fn one_handle_each(index: usize, entries: &[AttachmentEntry]) -> Result<(), CheckError> {
    let (mut grippers, mut handles) = (HashSet::new(), HashSet::new());
    for (number, entry) in entries.iter().enumerate() {
        for (key, name, seen) in [("gripper", &entry.gripper, &mut grippers), ("handle", &entry.handle, &mut handles)] {
            if let Some(name) = name
                && !seen.insert(name)
            {
                let place = format!("segments[{index}].attachments[{number}].{key}");
                return Err(CheckError::malformed(place, format!("`{}` takes part in two grasps", shown(name))));
            }
        }
    }
    Ok(())
}

struct Resolver<'a> {
    file: &'a PathFile,
    world: &'a World,
    frames: &'a Frames,
    place: String,
}

impl Resolver<'_> {
    fn refuse<T>(&self, key: &str, message: impl Into<String>) -> Result<T, CheckError> {
        Err(CheckError::malformed(format!("{}{key}", self.place), message))
    }

    fn attachment(&self, entry: &AttachmentEntry) -> Result<Attachment, CheckError> {
        let owner = entry.object.split('/').next().unwrap_or_default();
        let Some(part) = self.world.part(owner) else {
            return self.refuse(".object", format!("there is no part `{}`", shown(owner)));
        };
        let held = match (&entry.gripper, &entry.handle, &entry.surface, &entry.support, &entry.on) {
            (Some(gripper), Some(handle), None, None, None) => Some(self.grasp(gripper, handle)?),
            (None, None, Some(surface), Some(support), None) => Some(self.contact(surface, support)?),
            (None, None, None, None, Some(on)) => Some(self.rest(part, on)?),
            (None, None, None, None, None) => None,
            _ => {
                let message = "wants `gripper` and `handle`, or `surface` and `support`, or `on`, or none of them";
                return self.refuse("", message);
            }
        };
        if let Some((holder, link, bond)) = &held {
            self.owner(entry, part, *link, bond)?;
            if holder.part == part {
                return self.refuse("", format!("`{}` can neither hold nor carry itself", shown(&entry.object)));
            }
        }
        let name = match (&entry.gripper, &entry.handle, &entry.surface, &entry.support, &entry.on) {
            (Some(gripper), Some(handle), ..) => format!("{gripper} > {handle}"),
            (_, _, Some(surface), Some(support), _) => format!("{surface} on {support}"),
            (.., Some(on)) => format!("{} on {on}", entry.object),
            _ => format!("{} rests", entry.object),
        };
        Ok(Attachment { part, carrier: entry.carrier, name, held })
    }

    /// The object owns the handle or surface that its attachment names.
    fn owner(&self, entry: &AttachmentEntry, part: usize, link: Link, bond: &Bond) -> Result<(), CheckError> {
        let (key, what) = match bond {
            Bond::Grasp { .. } => (".handle", &entry.handle),
            Bond::Contact { .. } => (".surface", &entry.surface),
            Bond::Rest => return Ok(()),
        };
        let of_link = entry.object.contains('/');
        let same_link = || self.world.links.get(&entry.object).is_some_and(|l| l.frame.body == link.frame.body);
        if link.part == part && (!of_link || same_link()) {
            return Ok(());
        }
        let name = what.as_deref().unwrap_or_default();
        self.refuse(key, format!("`{}` is not on `{}`", shown(name), shown(&entry.object)))
    }

    fn grasp(&self, gripper: &str, handle: &str) -> Result<(Link, Link, Bond), CheckError> {
        let Some(&(holder, gripper)) = self.frames.grippers.get(gripper) else {
            return self.refuse(".gripper", format!("`{}` is not in documents.grippers", shown(gripper)));
        };
        let (Some(&(link, frame)), Some(entry)) =
            (self.frames.handles.get(handle), self.file.documents.handles.get(handle))
        else {
            return self.refuse(".handle", format!("`{}` is not in documents.handles", shown(handle)));
        };
        let bond = Bond::Grasp { gripper, handle: frame, mask: entry.mask, complement: entry.mask_complement };
        Ok((holder, link, bond))
    }

    fn rest(&self, part: usize, on: &str) -> Result<(Link, Link, Bond), CheckError> {
        let holder = self.world.link(on, || format!("{}.on", self.place))?;
        let Some(root) = self.world.links.get(&self.world.parts[part].root_link) else {
            return self.refuse(".object", "has no root link");
        };
        Ok((holder, *root, Bond::Rest))
    }

    fn contact(&self, surface: &str, support: &str) -> Result<(Link, Link, Bond), CheckError> {
        let find = |key: &str, name: &str| match self.frames.surfaces.get(name) {
            Some(&link) => Ok(link),
            None => self.refuse(key, format!("`{}` is not in documents.surfaces", shown(name))),
        };
        let (held, holder) = (find(".surface", surface)?, find(".support", support)?);
        Ok((holder, held, Bond::Contact { surface: surface.to_owned(), support: support.to_owned() }))
    }
}
