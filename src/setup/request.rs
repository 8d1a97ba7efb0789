//! What a person asks for: objects, a table.

use crate::setup::error::SetupError;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::str::FromStr;

/// An object of a new scene.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectRequest {
    /// A box of these sides, metres.
    Box(DVec3),
    /// A cylinder about z: radius and length, metres.
    Cylinder(f64, f64),
    /// A ball of this radius, metres.
    Sphere(f64),
    /// A mesh (STL, OBJ, PLY, COLLADA or glTF) and its scale.
    Mesh(String, f64),
    /// A URDF.
    Urdf(String),
}

/// What may be written for an object.
const FORMS: &str =
    "\"box X Y Z\", \"cylinder RADIUS LENGTH\", \"sphere RADIUS\" (metres), a mesh as \"FILE [SCALE]\", or a URDF";

impl FromStr for ObjectRequest {
    type Err = SetupError;

    fn from_str(text: &str) -> Result<Self, SetupError> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let refused = || SetupError::Request(format!("`{}` is no object; write {FORMS}", text.escape_debug()));
        let lengths = |words: &[&str]| -> Option<Vec<f64>> {
            words.iter().map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0)).collect()
        };
        let (Some(first), Some(rest)) = (words.first(), words.get(1..)) else { return Err(refused()) };
        let numbers = lengths(rest);
        match (*first, numbers.as_deref()) {
            ("box", Some(&[x, y, z])) => Ok(Self::Box(DVec3::new(x, y, z))),
            ("cylinder", Some(&[radius, length])) => Ok(Self::Cylinder(radius, length)),
            ("sphere", Some(&[radius])) => Ok(Self::Sphere(radius)),
            ("box" | "cylinder" | "sphere", _) => Err(refused()),
            _ => {
                // A file's name may hold blanks; a number behind it is a scale.
                let (file, scale) = match (text.trim().rsplit_once(char::is_whitespace), numbers) {
                    (Some((file, last)), _) if last.parse::<f64>().is_ok_and(|x| x.is_finite() && x > 0.0) => {
                        (file.trim(), last.parse().unwrap_or(1.0))
                    }
                    _ => (text.trim(), 1.0),
                };
                let ending = Path::new(file).extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
                match ending.as_str() {
                    "urdf" => Ok(Self::Urdf(file.to_owned())),
                    "stl" | "obj" | "ply" | "dae" | "glb" | "gltf" => Ok(Self::Mesh(file.to_owned(), scale)),
                    _ => Err(refused()),
                }
            }
        }
    }
}

impl ObjectRequest {
    /// What it is called: after its kind or its file.
    pub(crate) fn word(&self) -> String {
        let stem = |file: &str| {
            let stem =
                Path::new(file).file_stem().map(|stem| stem.to_string_lossy().to_lowercase()).unwrap_or_default();
            let plain: String =
                stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).take(40).collect();
            if plain.chars().next().is_some_and(|c| c.is_ascii_alphabetic()) {
                plain
            } else {
                format!("object_{plain}")
            }
        };
        match self {
            Self::Box(_) => "box".into(),
            Self::Cylinder(..) => "cylinder".into(),
            Self::Sphere(_) => "ball".into(),
            Self::Mesh(file, _) | Self::Urdf(file) => stem(file),
        }
    }
}

/// The table of a new scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableRequest {
    /// Sides of the top, metres.
    pub sides: (f64, f64),
    /// Height of the top, metres.
    pub height: f64,
    /// Where the middle of its top is and how its longer side is turned from x, as x, y (metres) and yaw (radians), seen from the root
    /// of the robot; none where it is to be found.
    pub place: Option<[f64; 3]>,
}

impl Default for TableRequest {
    fn default() -> Self {
        Self { sides: (1.2, 0.8), height: 0.75, place: None }
    }
}

impl FromStr for TableRequest {
    type Err = SetupError;

    fn from_str(text: &str) -> Result<Self, SetupError> {
        let numbers: Option<Vec<f64>> =
            text.split_whitespace().map(|word| word.parse::<f64>().ok().filter(|x| x.abs() < 100.0)).collect();
        let numbers = numbers.unwrap_or_default();
        let place = match numbers.get(3..) {
            Some(&[x, y]) => Some([x, y, FRAC_PI_2]),
            Some(&[x, y, yaw]) => Some([x, y, yaw]),
            _ => None,
        };
        match (numbers.as_slice(), place) {
            (&[a, b, height], _) | (&[a, b, height, ..], Some(_)) if a > 0.0 && b > 0.0 && height > 0.0 => {
                Ok(Self { sides: (a.max(b), a.min(b)), height, place })
            }
            _ => Err(SetupError::Request(format!(
                "`{}` is no table; write \"LENGTH WIDTH HEIGHT\", metres, and where its middle is, \"X Y\" or \"X Y YAW\" (metres and \
                 radians, the yaw of the longer side): \"1.2 0.8 0.75\", \"1.2 0.8 0.75 0.7 0.0\"",
                text.escape_debug()
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_and_tables_are_read_and_refused() {
        let object = |text: &str| text.parse::<ObjectRequest>().ok();
        assert_eq!(object("box 0.1 0.2 0.3"), Some(ObjectRequest::Box(DVec3::new(0.1, 0.2, 0.3))));
        assert_eq!(object("cylinder 0.02 0.1"), Some(ObjectRequest::Cylinder(0.02, 0.1)));
        assert_eq!(object("sphere 0.02"), Some(ObjectRequest::Sphere(0.02)));
        assert_eq!(object("my mug.stl 0.001"), Some(ObjectRequest::Mesh("my mug.stl".into(), 0.001)));
        assert_eq!(object("a/mug.OBJ"), Some(ObjectRequest::Mesh("a/mug.OBJ".into(), 1.0)));
        assert_eq!(object("mug.urdf"), Some(ObjectRequest::Urdf("mug.urdf".into())));
        assert_eq!(object("mug.glb 2"), Some(ObjectRequest::Mesh("mug.glb".into(), 2.0)));
        for wrong in ["", "box", "box 1 2", "box 1 2 -3", "sphere nan", "mug", "cylinder 1", "mug.step"] {
            assert_eq!(object(wrong), None, "{wrong}");
        }
        let table = |text: &str| text.parse::<TableRequest>().ok();
        let plain = TableRequest::default();
        assert_eq!(table("0.8 1.2 0.75"), Some(plain));
        assert_eq!(table("1.2 0.8 0.75 0.7 -0.1"), Some(TableRequest { place: Some([0.7, -0.1, FRAC_PI_2]), ..plain }));
        assert_eq!(table("1.2 0.8 0.75 0.7 0 0.5"), Some(TableRequest { place: Some([0.7, 0.0, 0.5]), ..plain }));
        for wrong in ["1 2", "1 2 0", "1 2 -3", "1 2 3 4", "1 2 3 4 5 6 7", "1 2 nan", "1 2 3 inf 0", "wide"] {
            assert_eq!(table(wrong), None, "{wrong}");
        }
    }
}
