//! Which shapes are tested against which, listed afresh from the rule: all shapes on different bodies, not both fixed in
//! the world, minus the SRDFs' disabled pairs of the same part, minus the pairs that the file ignores.

use super::CheckError;
use super::attachments::Attachment;
use super::models::{RigidBody, World, ordered, shown};
use super::report::CheckReport;
use crate::path_file::PathFile;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

/// Most pairs that are tested.
const MOST: usize = 4_000_000;

/// Pairs of shapes, as indices into the world's.
pub(super) struct Pairs {
    pub list: Vec<(usize, usize)>,
    /// Distances that pairs of the list keep; empty where the file has none.
    margins: Vec<f64>,
}

impl Pairs {
    pub(super) fn list(file: &PathFile, world: &World, report: &mut CheckReport) -> Result<Self, CheckError> {
        let ignored = ignored(file, world, report)?;
        let margins = margins(file, world)?;
        let mut pairs = Self { list: Vec::new(), margins: Vec::new() };
        for (first, one) in world.shapes.iter().enumerate() {
            for (second, other) in world.shapes.iter().enumerate().skip(first + 1) {
                if one.rigid == other.rigid || (one.world_fixed && other.world_fixed) {
                    continue;
                }
                let links = ordered(&one.link, &other.link);
                if one.rigid.0 == other.rigid.0 && world.disabled.contains(&links) {
                    report.counts.pairs_disabled_by_srdf += 1;
                } else if ignored.contains(&links) {
                    report.counts.pairs_ignored_by_file += 1;
                } else if pairs.list.len() == MOST {
                    return Err(CheckError::malformed("parts", format!("more than {MOST} pairs of shapes")));
                } else {
                    pairs.list.push((first, second));
                    if !margins.is_empty() {
                        pairs.margins.push(margins.get(&links).copied().unwrap_or(0.0));
                    }
                }
            }
        }
        report.counts.pairs = pairs.list.len();
        Ok(pairs)
    }

    /// The least distance allowed for each pair in a segment: its margin, unless the pair touches by grasp or placement
    /// where the transition that the segment travels begins or ends; then, and without margins, zero.
    pub(super) fn thresholds(
        &self,
        world: &World,
        file: &PathFile,
        attachments: &[Vec<Attachment>],
        segment: usize,
    ) -> Vec<f64> {
        if self.margins.is_empty() {
            return vec![0.0; self.list.len()];
        }
        let touching = touching(world, attachments[of_one_transition(file, segment)].iter().flatten());
        let threshold = |(&(a, b), &margin): (&(usize, usize), &f64)| {
            let bodies = (world.shapes[a].rigid, world.shapes[b].rigid);
            if touching.contains(&bodies) || touching.contains(&(bodies.1, bodies.0)) { 0.0 } else { margin }
        };
        self.list.iter().zip(&self.margins).map(threshold).collect()
    }
}

/// The segments that travel one transition together with a segment, and the ones before and after, which lie in the states
/// that it joins.
fn of_one_transition(file: &PathFile, segment: usize) -> Range<usize> {
    let segments = &file.segments;
    let name = &segments[segment].transition;
    let same = |other: &&crate::path_file::SegmentEntry| !name.is_empty() && other.transition == *name;
    let before = segments[..segment].iter().rev().take_while(same).count();
    let after = segments[segment + 1..].iter().take_while(same).count();
    (segment - before).saturating_sub(1)..(segment + after + 2).min(segments.len())
}

/// Bodies in contact: holder and held, and for a gripper also the bodies that hang directly on it (fingers).
fn touching<'a>(world: &World, attachments: impl Iterator<Item = &'a Attachment>) -> HashSet<(RigidBody, RigidBody)> {
    let mut found = HashSet::new();
    for attachment in attachments {
        let Some((holder, held, _)) = &attachment.held else { continue };
        found.insert((holder.rigid(), held.rigid()));
        if attachment.is_grasp() {
            let of_part = world.parts[holder.part].bodies.clone();
            let fingers = of_part.filter(|&b| world.bodies[b].parent == holder.frame.body);
            found.extend(fingers.map(|b| ((holder.part, Some(b)), held.rigid())));
        }
    }
    found
}

/// The file's own list. Each reason is told: a file that ignored everything would be free of collisions.
fn ignored(file: &PathFile, world: &World, report: &mut CheckReport) -> Result<HashSet<(String, String)>, CheckError> {
    let (mut pairs, mut reasons) = (HashSet::new(), BTreeMap::new());
    for (index, [first, second, reason]) in file.ignored_pairs.iter().enumerate() {
        world.link(first, || format!("ignored_pairs[{index}][0]"))?;
        world.link(second, || format!("ignored_pairs[{index}][1]"))?;
        pairs.insert(ordered(first, second));
        *reasons.entry(reason.as_str()).or_insert(0_usize) += 1;
    }
    for (reason, count) in reasons {
        report.note(format!("{count} link pairs ignored by the file: {}", shown(reason)));
    }
    Ok(pairs)
}

fn margins(file: &PathFile, world: &World) -> Result<HashMap<(String, String), f64>, CheckError> {
    let mut margins = HashMap::new();
    for (index, (first, second, margin)) in file.margins.iter().enumerate() {
        world.link(first, || format!("margins[{index}][0]"))?;
        world.link(second, || format!("margins[{index}][1]"))?;
        // Where a pair is given twice the larger counts; a negative margin allows no penetration.
        let entry = margins.entry(ordered(first, second)).or_insert(0.0_f64);
        *entry = entry.max(*margin);
    }
    Ok(margins)
}
