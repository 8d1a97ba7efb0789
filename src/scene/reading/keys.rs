//! TOML by hand: every value knows its line and its path, unknown keys are refused with the nearest known one.

use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use foliate_components::Pose;
use foliate_components::pose::{pose_from_array, rotation_from_rpy};
use glam::DVec3;
use std::ops::RangeInclusive;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file's text, for line numbers.
pub(crate) struct File<'a> {
    pub name: &'a str,
    /// What the whole file is.
    what: &'static str,
    line_starts: Vec<usize>,
}

impl<'a> File<'a> {
    pub fn new(name: &'a str, text: &str) -> Self {
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Self { name, what: "scene", line_starts }
    }

    /// A suite file.
    pub fn of_suite(name: &'a str, text: &str) -> Self {
        Self { what: "suite", ..Self::new(name, text) }
    }

    fn line(&self, offset: usize) -> u32 {
        self.line_starts.partition_point(|&start| start <= offset) as u32
    }

    /// Parses a text.
    pub fn parse(&self, text: &'a str) -> Result<Spanned<DeTable<'a>>, SceneError> {
        DeTable::parse(text).map_err(|e| {
            let line = e.span().map(|s| self.line(s.start));
            SceneError::new(self.name, "TOML", e.message().trim().replace('\n', ", ")).at(line).because(e)
        })
    }
}

/// A value and where it stands.
#[derive(Clone)]
pub(crate) struct Item<'f> {
    file: &'f File<'f>,
    path: String,
    offset: usize,
    value: &'f DeValue<'f>,
}

/// A table that is read key by key.
pub(crate) struct Keys<'f> {
    file: &'f File<'f>,
    path: String,
    offset: usize,
    table: &'f DeTable<'f>,
    asked: Vec<&'static str>,
}

impl<'f> Keys<'f> {
    pub fn root(file: &'f File<'f>, table: &'f Spanned<DeTable<'f>>) -> Self {
        Self { file, path: String::new(), offset: 0, table: table.get_ref(), asked: Vec::new() }
    }

    /// The value of a key, if it is there.
    pub fn optional(&mut self, key: &'static str) -> Option<Item<'f>> {
        self.asked.push(key);
        let (_, value) = self.table.iter().find(|(k, _)| k.get_ref() == key)?;
        Some(self.item(key, value))
    }

    /// The value of a key that must be there.
    pub fn required(&mut self, key: &'static str) -> Result<Item<'f>, SceneError> {
        self.optional(key).ok_or_else(|| self.error(format!("key `{key}` is missing")))
    }

    /// All keys and values, in the order of the file, for tables whose keys are names.
    pub fn entries(&self) -> Vec<(&'f str, Item<'f>)> {
        let mut all: Vec<_> =
            self.table.iter().map(|(k, v)| (k.get_ref().as_ref(), self.item(k.get_ref(), v))).collect();
        all.sort_by_key(|(_, item)| item.offset);
        all
    }

    /// Refuses keys that no reader has asked for.
    pub fn finish(self) -> Result<(), SceneError> {
        match self.table.iter().find(|(k, _)| !self.asked.contains(&k.get_ref().as_ref())) {
            Some((key, _)) => {
                let name = key.get_ref().as_ref();
                Err(SceneError::new(
                    self.file.name,
                    self.below(name),
                    format!("is no key of a {} file", self.file.what),
                )
                .at(self.file.line(key.span().start))
                .hint(did_you_mean(name, self.asked.iter().copied())))
            }
            None => Ok(()),
        }
    }

    pub fn error(&self, message: impl Into<String>) -> SceneError {
        let element = if self.path.is_empty() { self.file.what } else { &self.path };
        SceneError::new(self.file.name, element, message).at(self.file.line(self.offset))
    }

    fn below(&self, key: &str) -> String {
        if self.path.is_empty() { quoted(key) } else { format!("{}.{}", self.path, quoted(key)) }
    }

    fn item(&self, key: &str, value: &'f Spanned<DeValue<'f>>) -> Item<'f> {
        Item { file: self.file, path: self.below(key), offset: value.span().start, value: value.get_ref() }
    }
}

impl<'f> Item<'f> {
    pub fn error(&self, message: impl Into<String>) -> SceneError {
        SceneError::new(self.file.name, &self.path, message).at(self.file.line(self.offset))
    }

    fn wants<T>(&self, what: &str) -> Result<T, SceneError> {
        Err(self.error(format!("wants {what}, got {}", kind(self.value))))
    }

    pub fn is_table(&self) -> bool {
        matches!(self.value, DeValue::Table(_))
    }

    pub fn is_string(&self) -> bool {
        matches!(self.value, DeValue::String(_))
    }

    pub fn is_list(&self) -> bool {
        matches!(self.value, DeValue::Array(_))
    }

    pub fn string(&self) -> Result<&'f str, SceneError> {
        match self.value {
            DeValue::String(s) if s.trim().is_empty() => Err(self.error("is empty")),
            DeValue::String(s) => Ok(s.as_ref()),
            _ => self.wants("a string"),
        }
    }

    pub fn boolean(&self) -> Result<bool, SceneError> {
        match self.value {
            DeValue::Boolean(b) => Ok(*b),
            _ => self.wants("true or false"),
        }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, SceneError> {
        let parsed: Option<f64> = match self.value {
            DeValue::Float(f) => f.as_str().parse().ok(),
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse().ok(),
            _ => return self.wants("a number"),
        };
        parsed.filter(|x| x.is_finite()).ok_or_else(|| self.error("is not a finite number"))
    }

    /// A whole number within bounds.
    pub fn whole(&self, bounds: RangeInclusive<u64>) -> Result<u64, SceneError> {
        let number = self.number()?;
        let whole = (number.fract() == 0.0 && number >= 0.0).then_some(number as u64);
        let (low, high) = (bounds.start(), bounds.end());
        let wrong = || self.error(format!("wants a whole number from {low} to {high}, got {number}"));
        whole.filter(|whole| bounds.contains(whole)).ok_or_else(wrong)
    }

    /// A number that is not negative, say metres.
    pub fn distance(&self) -> Result<f64, SceneError> {
        match self.number()? {
            x if x < 0.0 => Err(self.error(format!("is negative: {x}"))),
            x => Ok(x),
        }
    }

    pub fn list(&self) -> Result<Vec<Item<'f>>, SceneError> {
        let DeValue::Array(items) = self.value else { return self.wants("a list") };
        let item = |(i, value): (usize, &'f Spanned<DeValue<'f>>)| Item {
            file: self.file,
            path: format!("{}[{i}]", self.path),
            offset: value.span().start,
            value: value.get_ref(),
        };
        Ok(items.iter().enumerate().map(item).collect())
    }

    pub fn numbers(&self) -> Result<Vec<f64>, SceneError> {
        self.list()?.iter().map(Item::number).collect()
    }

    pub fn array<const N: usize>(&self, what: &str) -> Result<[f64; N], SceneError> {
        let numbers = self.numbers()?;
        let wrong = || self.error(format!("wants {N} numbers, {what}, got {}", numbers.len()));
        <[f64; N]>::try_from(numbers.as_slice()).map_err(|_| wrong())
    }

    /// Six values, each 0, 1, false or true.
    pub fn mask(&self) -> Result<[bool; 6], SceneError> {
        self.flags("tx ty tz rx ry rz")
    }

    /// Values that are each 0, 1, false or true.
    pub fn flags<const N: usize>(&self, what: &str) -> Result<[bool; N], SceneError> {
        let values = self.list()?.iter().map(Item::flag).collect::<Result<Vec<bool>, SceneError>>()?;
        let wrong = || self.error(format!("wants {N} values, {what}, got {}", values.len()));
        <[bool; N]>::try_from(values.as_slice()).map_err(|_| wrong())
    }

    fn flag(&self) -> Result<bool, SceneError> {
        match self.value {
            DeValue::Boolean(b) => Ok(*b),
            _ => match self.number()? {
                0.0 => Ok(false),
                1.0 => Ok(true),
                x => Err(self.error(format!("{x} is neither 0 nor 1"))),
            },
        }
    }

    /// A lower and an upper bound.
    pub fn bounds(&self) -> Result<(f64, f64), SceneError> {
        let [low, high] = self.array("lower and upper")?;
        match low <= high {
            true => Ok((low, high)),
            false => Err(self.error(format!("the lower bound {low} is above the upper bound {high}"))),
        }
    }

    pub fn keys(&self) -> Result<Keys<'f>, SceneError> {
        let DeValue::Table(table) = self.value else { return self.wants("a table") };
        Ok(Keys { file: self.file, path: self.path.clone(), offset: self.offset, table, asked: Vec::new() })
    }

    /// `[x, y, z, qx, qy, qz, qw]`, or `{ xyz = […], rpy = […] }`, or `{ xyz = […], quaternion = [x, y, z, w] }`.
    pub fn pose(&self) -> Result<Pose, SceneError> {
        if !self.is_table() {
            let numbers = self.array("x y z qx qy qz qw")?;
            return self.unit_pose(numbers);
        }
        let mut keys = self.keys()?;
        let [x, y, z] = keys.optional("xyz").map_or(Ok([0.0; 3]), |i| i.array("x y z"))?;
        let (rpy, quaternion) = (keys.optional("rpy"), keys.optional("quaternion"));
        let pose = match (rpy, quaternion) {
            (Some(_), Some(second)) => return Err(second.error("gives the rotation a second time")),
            (Some(rpy), None) => {
                let [roll, pitch, yaw] = rpy.array("roll pitch yaw")?;
                Pose::from_parts(DVec3::new(x, y, z), rotation_from_rpy(roll, pitch, yaw))
            }
            (None, Some(quaternion)) => {
                let [qx, qy, qz, qw] = quaternion.array("x y z w")?;
                quaternion.unit_pose([x, y, z, qx, qy, qz, qw])?
            }
            (None, None) => Pose::from_translation(DVec3::new(x, y, z)),
        };
        keys.finish()?;
        Ok(pose)
    }

    fn unit_pose(&self, numbers: [f64; 7]) -> Result<Pose, SceneError> {
        let length = numbers[3..].iter().map(|x| x * x).sum::<f64>().sqrt();
        match pose_from_array(numbers) {
            Some(pose) if (length - 1.0).abs() < 1e-3 => Ok(pose),
            _ => Err(self
                .error(format!("the quaternion has length {length:.4}, a rotation has length 1"))
                .hint("order is x y z w; no rotation is 0 0 0 1")),
        }
    }
}

fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
