//! Names that people write: of links, parts, joints and coordinates.

use crate::scene::assemble::names::configuration::coordinate_names;
use crate::scene::reading::error::{did_you_mean, nearest, quoted};
use foliate_components::robot::{JointIndex, LinkIndex, PartIndex, Robot, Source};
use std::collections::HashMap;

/// A name that leads nowhere, and what may have been meant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} `{name}`{}{hint}", if hint.is_empty() { "" } else { ": " })]
pub struct UnknownName {
    /// What was looked for.
    pub what: &'static str,
    /// The name, fit for one line.
    pub name: String,
    /// What may have been meant; may be empty.
    pub hint: String,
}

impl UnknownName {
    fn new<'a>(what: &'static str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        Self { what, name: quoted(name), hint: did_you_mean(name, known) }
    }
}

/// The name without what stands before the last `/`.
fn bare(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The link `part/link`, or of that bare name where only one part has it.
pub(crate) fn link(robot: &Robot, name: &str) -> Result<LinkIndex, UnknownName> {
    if let Some(link) = robot.link(name) {
        return Ok(link);
    }
    let mut of_name = (0..robot.links.len()).filter(|&l| bare(&robot.links[l].name) == name);
    match (of_name.next(), of_name.next()) {
        (Some(link), None) => Ok(LinkIndex(link as u32)),
        _ => Err(UnknownName::new("link", name, robot.links.iter().map(|l| l.name.as_str()))),
    }
}

/// The part of a name.
pub(crate) fn part(robot: &Robot, name: &str) -> Result<PartIndex, UnknownName> {
    let known = || robot.parts.iter().map(|p| p.name.as_str());
    robot.part(name).ok_or_else(|| UnknownName::new("part", name, known()))
}

/// A link, or all links of a part.
pub(crate) fn links(robot: &Robot, name: &str) -> Result<Vec<LinkIndex>, UnknownName> {
    match robot.part(name) {
        Some(part) => Ok(robot.parts[part.at()].links.clone().map(|l| LinkIndex(l as u32)).collect()),
        None => Ok(vec![link(robot, name)?]),
    }
}

/// The links that are one body with a link, itself included; of what is fixed in the world only the link itself.
pub(crate) fn links_with(robot: &Robot, link: LinkIndex) -> Vec<LinkIndex> {
    let body = robot.links[link.at()].joint;
    let same = |&other: &usize| other == link.at() || (body.is_some() && robot.links[other].joint == body);
    (0..robot.links.len()).filter(same).map(|l| LinkIndex(l as u32)).collect()
}

/// The links that are one body with a link or are attached to it: a hand with its fingers.
pub(crate) fn links_beyond(robot: &Robot, link: LinkIndex) -> Vec<LinkIndex> {
    let Some(body) = robot.links[link.at()].joint else { return vec![link] };
    let is_fixed_to = |&other: &usize| {
        let mut at: Option<JointIndex> = robot.links[other].joint;
        while let Some(joint) = at {
            if joint == body {
                return true;
            }
            at = robot.joints[joint.at()].parent;
        }
        false
    };
    (0..robot.links.len()).filter(is_fixed_to).map(|l| LinkIndex(l as u32)).collect()
}

/// What the name of a joint in a file means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// A number of a configuration.
    Coordinate(usize),
    /// A joint that follows another one: `multiplier` · that coordinate + `offset`.
    Follower { coordinate: usize, multiplier: f64, offset: f64 },
}

/// The joints of a robot by all names that files may use for them.
pub(crate) struct JointNames {
    names: HashMap<String, Meaning>,
    /// Bare names that several parts have.
    ambiguous: HashMap<String, Vec<String>>,
    /// Full names in order, for hints.
    full: Vec<String>,
    order: Vec<String>,
}

impl JointNames {
    pub(crate) fn new(robot: &Robot) -> Self {
        let order = coordinate_names(robot);
        let mut all: Vec<(String, Meaning)> =
            order.iter().enumerate().map(|(i, name)| (name.clone(), Meaning::Coordinate(i))).collect();
        for joint in &robot.joints {
            let Source::Follows { leader, multiplier, offset } = joint.source else { continue };
            if let Source::Coordinates { q, .. } = robot.joints[leader.at()].source {
                all.push((joint.name.clone(), Meaning::Follower { coordinate: q, multiplier, offset }));
            }
        }
        let mut bare_names: HashMap<String, Vec<String>> = HashMap::new();
        // Roots go by their full names: every object has an x.
        for (name, _) in all.iter().filter(|(name, _)| robot.joint(name).is_some()) {
            bare_names.entry(bare(name).to_owned()).or_default().push(name.clone());
        }
        let full = all.iter().map(|(name, _)| name.clone()).collect();
        let mut names: HashMap<String, Meaning> = all.into_iter().collect();
        let mut ambiguous = HashMap::new();
        for (bare, meant) in bare_names {
            match (meant.as_slice(), names.contains_key(&bare)) {
                ([one], false) => {
                    if let Some(&meaning) = names.get(one) {
                        names.insert(bare, meaning);
                    }
                }
                (_, true) => {}
                _ => drop(ambiguous.insert(bare, meant)),
            }
        }
        Self { names, ambiguous, full, order }
    }

    /// Names of coordinates, in order.
    pub(crate) fn coordinates(&self) -> &[String] {
        &self.order
    }

    /// What a name means; the error is a message and a hint.
    pub(crate) fn find(&self, name: &str) -> Result<Meaning, (String, String)> {
        if let Some(&meaning) = self.names.get(name) {
            return Ok(meaning);
        }
        let shown = quoted(name);
        match self.ambiguous.get(name) {
            Some(meant) => {
                Err((format!("several joints are called `{shown}`"), format!("name one: {}", meant.join(", "))))
            }
            None => Err((format!("the scene has no joint `{shown}`"), self.hint(name))),
        }
    }

    /// What may have been meant; bare names are compared with bare names.
    fn hint(&self, name: &str) -> String {
        let near = nearest(name, self.full.iter().map(|full| bare(full)));
        match near.and_then(|near| self.full.iter().find(|full| bare(full) == near)) {
            Some(full) => format!("did you mean `{full}`?"),
            None => did_you_mean(name, self.full.iter().map(String::as_str)),
        }
    }
}

/// The coordinate of a name, `part/joint` or the bare name of a joint where only one part has it, as an index into a
/// configuration.
///
/// # Errors
/// There is none, or several.
pub fn find_coordinate(robot: &Robot, name: &str) -> Result<usize, UnknownName> {
    let unknown = |hint: String| UnknownName { what: "coordinate", name: quoted(name), hint };
    match JointNames::new(robot).find(name) {
        Ok(Meaning::Coordinate(i)) => Ok(i),
        Ok(Meaning::Follower { .. }) => Err(unknown(String::from("the joint follows another one"))),
        Err((_, hint)) => Err(unknown(hint)),
    }
}

/// The full name of a joint, `part/joint`.
///
/// # Errors
/// As [`find_coordinate`].
pub fn find_joint(robot: &Robot, name: &str) -> Result<String, UnknownName> {
    if robot.joint(name).is_some() {
        return Ok(name.to_owned());
    }
    Ok(coordinate_names(robot).swap_remove(find_coordinate(robot, name)?))
}
