//! Grippers, handles and surfaces of the file: where they are, and whether they are the SRDFs'.

use crate::check::report::check_report::{CheckReport, Place, shown};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::world::faces::are_joined;
use crate::check::world::models::{Frame, Link, World, corners};
use crate::path_file::constraint::PoseRow;
use crate::path_file::document::{PathFile, SurfaceEntry};
use foliate_components::Pose;
use foliate_components::pose::{pose_from_array, pose_to_array};
use foliate_components::robot::model::{Model, SurfaceModel};
use std::collections::HashMap;

/// How far a gripper, handle or contact point may be from the SRDF's, metres and quaternion entries.
const SLACK: f64 = 1e-6;

/// Where the file's documents are: their link, and their frame on its body.
pub(crate) struct Frames {
    pub grippers: HashMap<String, (Link, Frame)>,
    pub handles: HashMap<String, (Link, Frame)>,
    pub surfaces: HashMap<String, Link>,
}

impl Frames {
    pub(crate) fn new(file: &PathFile, world: &World) -> Result<Self, CheckError> {
        let documents = &file.documents;
        let mut frames = Self { grippers: HashMap::new(), handles: HashMap::new(), surfaces: HashMap::new() };
        for (name, entry) in &documents.grippers {
            let found = on_link(world, &entry.link, &entry.link_from_gripper, || place("grippers", name))?;
            frames.grippers.insert(name.clone(), found);
        }
        for (name, entry) in &documents.handles {
            let found = on_link(world, &entry.link, &entry.link_from_handle, || place("handles", name))?;
            frames.handles.insert(name.clone(), found);
        }
        for (name, entry) in &documents.surfaces {
            let link = world.link(&entry.link, || format!("{}.link", place("surfaces", name)))?;
            frames.surfaces.insert(name.clone(), link);
        }
        Ok(frames)
    }

    /// The frame that a constraint names: `world`, a part (its root link), a gripper, a handle, `part/link` or
    /// `part/joint`.
    pub(crate) fn named(&self, world: &World, name: &str, place: impl FnOnce() -> String) -> Result<Frame, CheckError> {
        if name == "world" {
            return Ok(Frame { body: None, body_from_frame: Pose::identity() });
        }
        if let Some(part) = world.part(name) {
            return world.link(&world.parts[part].root_link, place).map(|l| l.frame);
        }
        if let Some((_, frame)) = self.grippers.get(name).or_else(|| self.handles.get(name)) {
            return Ok(*frame);
        }
        match world.bodies.iter().position(|b| b.name == name) {
            Some(body) if !world.links.contains_key(name) => {
                Ok(Frame { body: Some(body), body_from_frame: Pose::identity() })
            }
            _ => world.link(name, place).map(|l| l.frame),
        }
    }
}

fn place(table: &str, name: &str) -> String {
    format!("documents.{table}[\"{}\"]", shown(name))
}

fn on_link(world: &World, link: &str, row: &PoseRow, place: impl Fn() -> String) -> Result<(Link, Frame), CheckError> {
    let link = world.link(link, || format!("{}.link", place()))?;
    let pose = pose_from_array(*row).ok_or_else(|| CheckError::malformed(place(), "is no pose"))?;
    Ok((link, Frame { body: link.frame.body, body_from_frame: link.frame.body_from_frame * pose }))
}

/// Compares the file's documents with those of its parts' SRDFs.
pub(crate) fn check(file: &PathFile, world: &World, report: &mut CheckReport) {
    let documents = &file.documents;
    let owner = |name: &str| {
        let (part, local) = name.split_once('/')?;
        let part = &world.parts[world.part(part)?];
        Some((part.name.clone(), &part.model, local.to_owned()))
    };
    owned(file, report);
    for (name, entry) in &documents.grippers {
        let Some((part, model, local)) = owner(name) else { continue };
        match model.grippers.iter().find(|g| g.name == local) {
            None => from_the_scene(name, model, report),
            Some(known) => {
                same_link(name, &entry.link, &part, &known.link, report);
                same_pose(name, &entry.link_from_gripper, &known.link_from_gripper, report);
            }
        }
    }
    for (name, entry) in &documents.handles {
        let Some((part, model, local)) = owner(name) else { continue };
        match model.handles.iter().find(|h| h.name == local) {
            None => from_the_scene(name, model, report),
            Some(known) => {
                same_link(name, &entry.link, &part, &known.link, report);
                same_pose(name, &entry.link_from_handle, &known.link_from_handle, report);
                if (entry.mask, entry.mask_complement) != (known.mask, known.mask_complement) {
                    report.weaker(format!("masks of {} are not the SRDF's", shown(name)));
                }
            }
        }
    }
    for (name, entry) in &documents.surfaces {
        let Some((part, model, local)) = owner(name) else { continue };
        match model.surfaces.iter().find(|s| s.name == local) {
            None => from_the_scene(name, model, report),
            Some(known) => {
                same_link(name, &entry.link, &part, &known.link, report);
                // By the rule of centres documents are taken as they are.
                same_surface(name, entry, known, file.rests.is_some(), report);
            }
        }
    }
}

fn from_the_scene(name: &str, model: &Model, report: &mut CheckReport) {
    let why = if model.has_srdf { "is not in the SRDF" } else { "is of a part without SRDF" };
    report.weaker(format!("{} {why}", shown(name)));
}

/// A document has the name of the part that its link belongs to; without a part it would be compared with no model.
fn owned(file: &PathFile, report: &mut CheckReport) {
    let documents = &file.documents;
    let grippers = documents.grippers.iter().map(|(name, entry)| (name, &entry.link));
    let handles = documents.handles.iter().map(|(name, entry)| (name, &entry.link));
    let surfaces = documents.surfaces.iter().map(|(name, entry)| (name, &entry.link));
    for (name, link) in grippers.chain(handles).chain(surfaces) {
        let owner = |text: &str| text.split_once('/').map(|(part, _)| part.to_owned());
        if owner(name).is_none() || owner(name) != owner(link) {
            let subject = format!("{} is on {}, and not called after its part", shown(name), shown(link));
            report.violate(Place::FILE, Kind::Document, subject, None, None);
        }
    }
}

fn same_link(name: &str, link: &str, part: &str, known: &str, report: &mut CheckReport) {
    if link.split_once('/') != Some((part, known)) {
        let subject = format!("{} is on {}, in the SRDF on {part}/{known}", shown(name), shown(link));
        report.violate(Place::FILE, Kind::Document, subject, None, None);
    }
}

fn same_pose(name: &str, row: &PoseRow, known: &Pose, report: &mut CheckReport) {
    let known = pose_to_array(known);
    let dot: f64 = row[3..].iter().zip(&known[3..]).map(|(a, b)| a * b).sum();
    let sign = if dot < 0.0 { -1.0 } else { 1.0 };
    let apart = |(i, (a, b)): (usize, (&f64, &f64))| if i < 3 { (a - b).abs() } else { (sign * a - b).abs() };
    let difference = row.iter().zip(&known).enumerate().map(apart).fold(0.0, f64::max);
    if difference > SLACK {
        let subject = format!("pose of {} is not the SRDF's", shown(name));
        report.violate(Place::FILE, Kind::Document, subject, difference, SLACK);
    }
}

fn same_surface(name: &str, entry: &SurfaceEntry, known: &SurfaceModel, may_be_joined: bool, report: &mut CheckReport) {
    let ours: Vec<_> = entry.polygons.iter().map(|p| corners(entry, p)).collect();
    let points = |p: &Vec<u32>| p.iter().filter_map(|&i| known.points.get(i as usize).copied()).collect::<Vec<_>>();
    let theirs: Vec<_> = known.polygons.iter().map(points).collect();
    let same_shape = ours.len() == theirs.len() && ours.iter().zip(&theirs).all(|(a, b)| a.len() == b.len());
    let apart = ours.iter().flatten().zip(theirs.iter().flatten()).map(|(a, b)| (*a - *b).abs().max_element());
    if may_be_joined && !same_shape && are_joined(&ours, &theirs) {
        return;
    }
    let difference = if same_shape { apart.fold(0.0, f64::max) } else { f64::INFINITY };
    if difference > SLACK {
        let subject = format!("polygons of {} are not the SRDF's", shown(name));
        report.violate(Place::FILE, Kind::Document, subject, difference, SLACK);
    }
}
