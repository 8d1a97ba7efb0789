//! Numbers as a person would write them: six digits behind the point at most.

use foliate_components::Pose;
use foliate_components::pose::{pose_from_array, pose_to_array};
use glam::DVec3;

/// Digits behind the point.
const DIGITS: f64 = 1e6;

/// A number, rounded to micrometres or microradians.
pub(crate) fn rounded(x: f64) -> f64 {
    let rounded = (x * DIGITS).round() / DIGITS;
    // No -0.
    rounded + 0.0
}

/// A pose as it reads back from a scene.
pub(crate) fn pose_as_written(pose: &Pose) -> Pose {
    let numbers = pose_to_array(pose).map(rounded);
    match is_plain(&numbers) {
        true => Pose::from_translation(DVec3::new(numbers[0], numbers[1], numbers[2])),
        false => pose_from_array(numbers).unwrap_or(*pose),
    }
}

/// Whether nothing is turned.
fn is_plain(numbers: &[f64; 7]) -> bool {
    numbers[3..] == [0.0, 0.0, 0.0, 1.0] || numbers[3..] == [0.0, 0.0, 0.0, -1.0]
}

/// A number for TOML.
pub(crate) fn number(x: f64) -> String {
    let x = rounded(x);
    if x == x.trunc() && x.abs() < 1e15 { format!("{x:.1}") } else { format!("{x}") }
}

/// A number within bounds: rounding never leaves them.
pub(crate) fn number_within(x: f64, (low, high): (f64, f64)) -> String {
    match rounded(x) {
        r if r >= low && r <= high => number(x),
        _ => format!("{:?}", x.clamp(low, high)),
    }
}

/// Numbers in brackets.
pub(crate) fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|x| number(*x)).collect();
    format!("[{}]", numbers.join(", "))
}

/// A point.
pub(crate) fn point(p: DVec3) -> String {
    list(&p.to_array())
}

/// A pose as a table: only what differs from the identity.
pub(crate) fn pose(pose: &Pose) -> String {
    let numbers = pose_to_array(pose).map(rounded);
    let xyz = list(&numbers[..3]);
    match is_plain(&numbers) {
        true => format!("{{ xyz = {xyz} }}"),
        false => format!("{{ xyz = {xyz}, quaternion = {} }}", list(&numbers[3..])),
    }
}

/// Six flags.
pub(crate) fn mask(mask: [bool; 6]) -> String {
    format!("[{}]", mask.map(|m| if m { "1" } else { "0" }).join(", "))
}

/// A text in quotation marks.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_within_a_micrometre_and_within_bounds() {
        for (x, text) in [(0.1 + 0.2, "0.3"), (-1e-9, "0.0"), (2.0, "2.0"), (-0.123456789, "-0.123457")] {
            assert_eq!(number(x), text);
        }
        let pi = std::f64::consts::PI;
        assert_eq!(number(pi), "3.141593");
        assert_eq!(number_within(pi, (-pi, pi)), "3.141592653589793");
        assert_eq!(pose(&Pose::from_translation(DVec3::X)), "{ xyz = [1.0, 0.0, 0.0] }");
        assert_eq!(quoted("a\"b"), "\"a\\\"b\"");
    }
}
