//! A start in a file of its own, as sensors give it: joints and poses by name, in JSON.

use crate::scene::assemble::names::configuration::{Reader, coordinate_names};
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::input;
use crate::scene::sources::source::sha256;
use foliate_components::pose::{pose_from_array, pose_to_array};
use foliate_components::robot::{JointType, Robot, Source};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// How far a quaternion may be from length 1.
const UNIT: f64 = 1e-3;

/// An object that has each name once: JSON would take the last of two.
struct Once(Map<String, Value>);

impl<'de> Deserialize<'de> for Once {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Names;
        impl<'de> Visitor<'de> for Names {
            type Value = Once;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of names and values")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Once, A::Error> {
                let mut values = Map::new();
                while let Some((name, value)) = entries.next_entry::<String, Value>()? {
                    if values.contains_key(&name) {
                        return Err(A::Error::custom(format!("`{}` is named a second time", quoted(&name))));
                    }
                    values.insert(name, value);
                }
                Ok(Once(values))
            }
        }
        deserializer.deserialize_map(Names)
    }
}

/// Where a scene starts instead of where it says: a JSON object of names and values.
///
/// A name is that of a coordinate (`part/joint`; without the part where only one part has the joint) and its value a number, or that of
/// a part and its value the pose of its free root (`[x, y, z, qx, qy, qz, qw]`), `[x, y, theta]` of a planar one, or the name of a
/// configuration of its SRDF. Metres and radians. What it does not name starts where the scene has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StartFile {
    path: PathBuf,
    text: String,
    sha256: String,
}

impl StartFile {
    /// Reads a file; its names are compared with a scene's where one is loaded with it.
    ///
    /// # Errors
    /// A file that is missing, too large or no text.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        let content = input::bytes(path, input::SCENE_CAP)?;
        let sha256 = sha256(&content);
        let text = input::decode(content, &path.display().to_string())?;
        Ok(Self { path: path.to_owned(), text, sha256 })
    }

    /// Where it was read.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// SHA-256 of its bytes, hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Writes its values into a start.
    pub(crate) fn apply(&self, reader: &Reader<'_>, start: &mut [f64]) -> Result<(), SceneError> {
        let Once(values) = serde_json::from_str(&self.text).map_err(|error| {
            let line = u32::try_from(error.line()).ok().filter(|line| *line > 0);
            let hint = "a start is a JSON object of names and values: {\"robot/joint\": 0.3}";
            self.error("JSON", error.to_string()).at(line).because(error).hint(hint)
        })?;
        let names = coordinate_names(reader.robot);
        // Named configurations first: what is named beside them holds.
        for (name, value) in values.iter().filter(|(_, value)| value.is_string()) {
            let place = self.configuration(name, value, reader.robot, &names)?;
            place.into_iter().for_each(|(index, value)| start[index] = value);
        }
        let mut given: BTreeMap<usize, &str> = BTreeMap::new();
        for (name, value) in values.iter().filter(|(_, value)| !value.is_string()) {
            for index in self.value(name, value, (reader.robot, &names), start)? {
                if let Some(other) = given.insert(index, name) {
                    let message = format!("gives `{}`, as `{}` does", names[index], quoted(other));
                    return Err(self.error(name, message).hint("name each coordinate once"));
                }
            }
        }
        for &(joint, value) in reader.locked {
            let joint = &reader.robot.joints[joint.at()];
            let Source::Coordinates { q, .. } = joint.source else { continue };
            if (start[q] - value).abs() > 1e-9 {
                let message = format!("is {}, and the scene locks it at {value}", start[q]);
                return Err(self.error(&joint.name, message).hint("a locked joint never moves"));
            }
        }
        Ok(())
    }

    fn error(&self, element: &str, message: impl Into<String>) -> SceneError {
        SceneError::new(self.path.display().to_string(), quoted(element), message)
    }

    fn unknown(&self, name: &str, robot: &Robot, names: &[String]) -> SceneError {
        let parts = robot.parts.iter().map(|part| part.name.as_str());
        let hint = did_you_mean(name, names.iter().map(String::as_str).chain(parts));
        self.error(name, "there is no coordinate or part of this name in the scene").hint(hint)
    }

    /// The values of a part's named configuration.
    fn configuration(
        &self,
        name: &str,
        value: &Value,
        robot: &Robot,
        names: &[String],
    ) -> Result<Vec<(usize, f64)>, SceneError> {
        let wanted = value.as_str().unwrap_or_default();
        let part = robot.parts.iter().find(|part| part.name == name);
        let part = part.ok_or_else(|| self.unknown(name, robot, names))?;
        let Some(state) = part.group_states.iter().find(|state| state.name == wanted) else {
            let states = part.group_states.iter().map(|state| state.name.as_str());
            let message = format!("has no configuration `{}`", quoted(wanted));
            return Err(self.error(name, message).hint(did_you_mean(wanted, states)));
        };
        if let Some(contradiction) = &state.contradiction {
            let message = format!("configuration `{}` contradicts itself: {contradiction}", quoted(wanted));
            return Err(self.error(name, message));
        }
        let at = |(joint, value): &(String, f64)| {
            let full = format!("{}/{joint}", part.name);
            Some((names.iter().position(|known| *known == full)?, *value))
        };
        Ok(state.values.iter().filter_map(at).collect())
    }

    /// Writes a value; returns which coordinates it gives.
    fn value(
        &self,
        name: &str,
        value: &Value,
        (robot, names): (&Robot, &[String]),
        start: &mut [f64],
    ) -> Result<Range<usize>, SceneError> {
        if let Some(part) = robot.parts.iter().find(|part| part.name == name) {
            let root = part.root_joint.map(|joint| &robot.joints[joint.at()]);
            let Some((joint, Source::Coordinates { q, .. })) = root.map(|joint| (joint, joint.source)) else {
                return Err(self.error(name, "its root does not move").hint("name joints: \"part/joint\""));
            };
            let size = joint.motion.configuration_size();
            let numbers = self.numbers(name, value, size)?;
            start[q..q + size].copy_from_slice(&match joint.motion {
                JointType::FreeFlyer => self.pose(name, &numbers)?.to_vec(),
                _ => numbers,
            });
            return Ok(q..q + size);
        }
        let number = value.as_f64().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| self.error(name, "wants a finite number"));
        let index = self.coordinate(name, robot, names)?;
        start[index] = number?;
        Ok(index..index + 1)
    }

    /// The coordinate of a name, without its part too where only one part has it.
    fn coordinate(&self, name: &str, robot: &Robot, names: &[String]) -> Result<usize, SceneError> {
        if let Some(index) = names.iter().position(|known| known == name) {
            return Ok(index);
        }
        let is_it = |known: &&String| known.split_once('/').is_some_and(|(_, local)| local == name);
        match names.iter().filter(is_it).collect::<Vec<_>>()[..] {
            [only] => Ok(names.iter().position(|known| known == only).unwrap_or_default()),
            [] => Err(self.unknown(name, robot, names)),
            [first, second, ..] => {
                let message = format!("is `{first}` or `{second}`");
                Err(self.error(name, message).hint("name the part too"))
            }
        }
    }

    fn numbers(&self, name: &str, value: &Value, size: usize) -> Result<Vec<f64>, SceneError> {
        let what = if size == 3 { "[x, y, theta]" } else { "[x, y, z, qx, qy, qz, qw]" };
        let wrong = || self.error(name, format!("wants {size} finite numbers, {what}"));
        let numbers = value.as_array().filter(|numbers| numbers.len() == size).ok_or_else(wrong)?;
        let number = |number: &Value| number.as_f64().filter(|number| number.is_finite()).ok_or_else(wrong);
        numbers.iter().map(number).collect()
    }

    fn pose(&self, name: &str, numbers: &[f64]) -> Result<[f64; 7], SceneError> {
        let length = numbers[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
        let read = <[f64; 7]>::try_from(numbers).ok().and_then(pose_from_array);
        read.filter(|_| (length - 1.0).abs() < UNIT).map(|pose| pose_to_array(&pose)).ok_or_else(|| {
            let message = format!("the quaternion has length {length:.4}, a rotation has length 1");
            self.error(name, message).hint("order is x y z w")
        })
    }
}
