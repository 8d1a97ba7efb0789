//! The file of problems: JSON, as it is or compressed by gzip. `benches/README.md` describes the form.

use flate2::read::GzDecoder;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Bytes of a file at most, after decompression.
const LARGEST: u64 = 256 << 20;

/// How much the length of a quaternion may differ from 1.
const UNIT: f64 = 1e-3;

/// The file.
#[derive(Clone, Debug, Deserialize)]
pub struct ProblemSets {
    /// The robot of all problems: `panda`, `fetch`, ….
    pub robot: String,
    /// Order of the numbers of quaternions. Only `x y z w` is read.
    #[serde(default = "x_y_z_w")]
    pub quaternions: String,
    /// Problems by the name of their set.
    pub sets: BTreeMap<String, Vec<ProblemRecord>>,
}

fn x_y_z_w() -> String {
    "x y z w".into()
}

/// One problem: a robot among solids that stand still.
#[derive(Clone, Debug, Deserialize)]
pub struct ProblemRecord {
    /// Its number in the set.
    pub index: u64,
    /// Value of each joint at the start, radians or metres.
    pub start: BTreeMap<String, f64>,
    /// Value of each joint that moves at the goal, radians or metres.
    pub goal: BTreeMap<String, f64>,
    /// What stands around.
    pub obstacles: Vec<Obstacle>,
}

/// A solid that stands still.
#[derive(Clone, Debug, Deserialize)]
pub struct Obstacle {
    /// Its name.
    pub name: String,
    /// Its centre in the world, metres.
    pub xyz: [f64; 3],
    /// Its orientation in the world, x, y, z, w, of length 1.
    pub quaternion: [f64; 4],
    /// Its shape.
    #[serde(flatten)]
    pub shape: Shape,
}

/// A primitive shape, its centre at the origin.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Shape {
    /// A box.
    Box {
        /// Whole sides, metres.
        size: [f64; 3],
    },
    /// A cylinder about z.
    Cylinder {
        /// Along z, metres.
        length: f64,
        /// Metres.
        radius: f64,
    },
    /// A sphere.
    Sphere {
        /// Metres.
        radius: f64,
    },
}

impl ProblemSets {
    /// Reads a file: JSON, or JSON compressed by gzip where the name ends in `.gz`.
    ///
    /// # Errors
    /// What is wrong, with the file, and the line and column or the set and the number of the problem.
    pub fn read(path: &Path) -> Result<Self, String> {
        let of_file = |error: String| format!("{}: {error}", path.display());
        let file = File::open(path).map_err(|error| of_file(error.to_string()))?;
        let is_compressed = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz"));
        let text = match is_compressed {
            true => text_of(GzDecoder::new(BufReader::new(file))).map_err(|e| format!("{e} (read as gzip: `.gz`)")),
            false => text_of(file),
        };
        Self::parse(&text.map_err(of_file)?).map_err(of_file)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// As [`Self::read`], without the name of the file.
    pub fn parse(text: &str) -> Result<Self, String> {
        let sets: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        sets.check()?;
        Ok(sets)
    }

    fn check(&self) -> Result<(), String> {
        if self.quaternions != x_y_z_w() {
            return Err(format!("`quaternions` is \"{}\"; only \"x y z w\" is read", self.quaternions.escape_debug()));
        }
        if self.sets.values().all(Vec::is_empty) {
            return Err("`sets` has no problems".into());
        }
        for (name, problems) in &self.sets {
            let mut seen = std::collections::HashSet::new();
            for problem in problems {
                let place = |error| format!("set `{}`, problem {}: {error}", name.escape_debug(), problem.index);
                problem.check().map_err(place)?;
                if !seen.insert(problem.index) {
                    return Err(place("the set has two problems of this index".into()));
                }
            }
        }
        Ok(())
    }
}

fn text_of(from: impl Read) -> Result<String, String> {
    let mut text = String::new();
    let size = from.take(LARGEST + 1).read_to_string(&mut text).map_err(|error| error.to_string())?;
    if size as u64 > LARGEST {
        return Err(format!("has more than {} MiB", LARGEST >> 20));
    }
    Ok(text)
}

impl ProblemRecord {
    fn check(&self) -> Result<(), String> {
        if self.goal.is_empty() {
            return Err("`goal` names no joint".into());
        }
        if let Some(joint) = self.goal.keys().find(|joint| !self.start.contains_key(*joint)) {
            return Err(format!("`goal` has joint `{}`, `start` has not", joint.escape_debug()));
        }
        self.obstacles.iter().try_for_each(Obstacle::check)
    }
}

impl Obstacle {
    fn check(&self) -> Result<(), String> {
        let place = |error: &str| Err(format!("obstacle `{}`: {error}", self.name.escape_debug()));
        let length = self.quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (length - 1.0).abs() > UNIT {
            return place(&format!("the length of `quaternion` is {length}, not 1"));
        }
        let sizes: &[f64] = match &self.shape {
            Shape::Box { size } => size,
            Shape::Cylinder { length, radius } => &[*length, *radius],
            Shape::Sphere { radius } => &[*radius],
        };
        match sizes.iter().all(|&size| size > 0.0) {
            true => Ok(()),
            false => place("sizes are above 0"),
        }
    }
}
