//! Which shapes are tested against which, listed afresh from the rule: all shapes on different bodies, not both fixed in
//! the world, minus the SRDFs' disabled pairs of the same part, minus the pairs that the file ignores.

use crate::check::clearance::adjacent;
use crate::check::clearance::adjacent::ADJACENT;
use crate::check::report::check_report::{CheckReport, LeftOut, Place, shown};
use crate::check::report::error::CheckError;
use crate::check::report::kind::Kind;
use crate::check::world::attachments::Attachment;
use crate::check::world::models::{RigidBody, World, ordered};
use crate::path_file::document::PathFile;
use foliate_components::robot::PartKind;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ops::Range;

/// Most pairs that are tested.
const MOST: usize = 4_000_000;

/// Pairs of shapes, as indices into the world's.
pub(crate) struct Pairs {
    pub list: Vec<(usize, usize)>,
    /// Distances that pairs of the list keep; empty where the file has none.
    margins: Vec<f64>,
}

/// What is left out of the test: pairs of links, the smaller name first, with the reason.
pub(crate) type Ignored = HashMap<(String, String), String>;

impl Pairs {
    pub(crate) fn list(
        file: &PathFile,
        world: &World,
        ignored: &Ignored,
        report: &mut CheckReport,
        by_name: bool,
    ) -> Result<Self, CheckError> {
        let margins = margins(file, world)?;
        let mut pairs = Self { list: Vec::new(), margins: Vec::new() };
        let mut left_out = BTreeMap::new();
        for (first, one) in world.shapes.iter().enumerate() {
            for (second, other) in world.shapes.iter().enumerate().skip(first + 1) {
                let counts = &mut report.counts;
                // The joints of an environment stand still, wherever the file has them.
                let one_part = one.rigid.0 == other.rigid.0;
                let is_rigid = one_part && world.parts[one.rigid.0].kind == PartKind::Environment;
                if one.rigid == other.rigid || is_rigid {
                    counts.pairs_of_one_body += 1;
                    continue;
                }
                if one.world_fixed && other.world_fixed {
                    counts.pairs_of_the_environment += 1;
                    continue;
                }
                let links = ordered(&one.link, &other.link);
                let disabled = one_part && world.disabled.contains(&links);
                let reason = if disabled { Some("srdf") } else { ignored.get(&links).map(String::as_str) };
                match reason {
                    Some("srdf") => counts.pairs_disabled_by_srdf += 1,
                    Some(ADJACENT) => counts.pairs_adjacent += 1,
                    Some(_) => counts.pairs_ignored_by_file += 1,
                    None if pairs.list.len() == MOST => {
                        return Err(CheckError::malformed("parts", format!("more than {MOST} pairs of shapes")));
                    }
                    None => {
                        pairs.list.push((first, second));
                        if !margins.is_empty() {
                            pairs.margins.push(margins.get(&links).copied().unwrap_or(0.0));
                        }
                    }
                }
                if let Some(reason) = reason.filter(|_| by_name) {
                    left_out.insert(links, reason.to_owned());
                }
            }
        }
        report.counts.pairs = pairs.list.len();
        let left_out = left_out.into_iter().map(|((first, second), reason)| LeftOut { first, second, reason });
        report.left_out = left_out.collect();
        Ok(pairs)
    }

    /// The least distance allowed for each pair in a segment: its margin, unless the pair touches by grasp or placement
    /// where the transition that the segment travels begins or ends; then, and without margins, zero.
    pub(crate) fn thresholds(
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
    let same = |other: &&crate::path_file::document::SegmentEntry| !name.is_empty() && other.transition == *name;
    let before = segments[..segment].iter().rev().take_while(same).count();
    let after = segments[segment + 1..].iter().take_while(same).count();
    (segment - before).saturating_sub(1)..(segment + after + 2).min(segments.len())
}

/// Bodies in contact: holder and held, and for a gripper also the bodies that move with its own (fingers, joint after joint).
fn touching<'a>(world: &World, attachments: impl Iterator<Item = &'a Attachment>) -> HashSet<(RigidBody, RigidBody)> {
    let mut found = HashSet::new();
    for attachment in attachments {
        let Some((holder, held, _)) = &attachment.held else { continue };
        found.insert((holder.rigid(), held.rigid()));
        if attachment.is_grasp() {
            let of_part = world.parts[holder.part].bodies.clone();
            let hand = holder.frame.body;
            let fingers = of_part.filter(|&b| hand.is_some_and(|hand| is_beyond(world, b, hand)));
            found.extend(fingers.map(|b| ((holder.part, Some(b)), held.rigid())));
        }
    }
    found
}

/// Whether a body is attached to another one, over any number of joints.
fn is_beyond(world: &World, body: usize, carrier: usize) -> bool {
    std::iter::successors(world.bodies[body].parent, |&b| world.bodies[b].parent).any(|b| b == carrier)
}

/// The file's own list, looked through: neighbours are proved from the models, everything else is believed and told. A file
/// that ignored everything would be free of collisions.
pub(crate) fn ignored(file: &PathFile, world: &World, report: &mut CheckReport) -> Result<Ignored, CheckError> {
    let (mut pairs, mut reasons) = (Ignored::new(), BTreeMap::new());
    for (index, [first, second, reason]) in file.ignored_pairs.iter().enumerate() {
        world.link(first, || format!("ignored_pairs[{index}][0]"))?;
        world.link(second, || format!("ignored_pairs[{index}][1]"))?;
        if reason != ADJACENT {
            // One reason is enough: a pair that is ignored anyway need not be one of neighbours.
            pairs.insert(ordered(first, second), reason.clone());
            *reasons.entry(reason.as_str()).or_insert(0_usize) += 1;
        }
    }
    for (reason, count) in reasons {
        report.weaker(format!("{count} link pairs ignored by the file: {}", shown(reason)));
    }
    let claimed: BTreeSet<_> = adjacent::claimed(file).filter(|links| !pairs.contains_key(links)).collect();
    if claimed.is_empty() {
        return Ok(pairs);
    }
    let neighbours = adjacent::Neighbours::new(world, file);
    for (first, second) in claimed {
        // What no shape is on, or what an SRDF disables, is not tested in any case.
        let needless =
            world.disabled.contains(&(first.clone(), second.clone())) || !neighbours.have_shapes(&first, &second);
        if !needless && !neighbours.are(&first, &second) {
            let subject = format!("{first} and {second} do not touch wherever one joint is, or are not joined by one");
            report.violate(Place::FILE, Kind::NotAdjacent, subject, None, None);
            continue;
        }
        pairs.insert((first, second), ADJACENT.into());
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
