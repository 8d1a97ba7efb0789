//! Promise: `docs/path-file.md` describes every key of a path file, and every verdict, section and kind of violation of a check.

#![allow(clippy::expect_used, reason = "a test that cannot go on says so")]

const REFERENCE: &str = include_str!("../docs/path-file.md");
const KEYS: [&str; 2] = [include_str!("../src/path_file/document.rs"), include_str!("../src/path_file/constraint.rs")];
const WORDS: &str = include_str!("../src/check/report/kind.rs");

fn is_described(word: &str) -> bool {
    REFERENCE.contains(&format!("`{word}`"))
}

#[test]
fn every_key_is_described() {
    let fields = |source: &'static str| source.lines().filter_map(|line| line.trim().strip_prefix("pub "));
    let keys = KEYS.into_iter().flat_map(fields).filter_map(|field| field.split_once(": ").map(|(name, _)| name));
    let keys: Vec<&str> = keys.filter(|key| !key.contains(' ')).collect();
    assert!(keys.len() > 60, "the sources have other keys: {keys:?}");
    let missing: Vec<_> = keys.into_iter().filter(|key| !is_described(key)).collect();
    assert!(missing.is_empty(), "docs/path-file.md does not describe {missing:?}");
}

/// The numbers of the worked example are those of its curve.
#[test]
fn the_worked_example_keeps_what_it_claims() {
    let (_, block) = REFERENCE.split_once("```json\n").expect("an example");
    let (text, _) = block.split_once("```").expect("its end");
    let example: serde_json::Value = serde_json::from_str(text).expect("JSON");
    assert_eq!(example["format"], foliate::path_file::FORMAT);
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let limits = &example["rate_limits"]["arm/elbow"];
    let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
    for segment in example["segments"].as_array().expect("segments") {
        for knot in 0..2 {
            let at = |key: &str, knot: usize| number(segment[key][knot].get(0).unwrap_or(&segment[key][knot]));
            let h = at("times", knot + 1) - at("times", knot);
            let (d, a, b) =
                (at("knots", knot + 1) - at("knots", knot), h * at("velocities", knot), h * at("velocities", knot + 1));
            for step in 0..=1000 {
                let s = f64::from(step) / 1000.0;
                let (second, third) = (3.0 * d - 2.0 * a - b, a + b - 2.0 * d);
                fastest = fastest.max((a + 2.0 * second * s + 3.0 * third * s * s).abs() / h);
                hardest = hardest.max((2.0 * second + 6.0 * third * s).abs() / (h * h));
            }
        }
    }
    for (claim, found, limit) in [("max_velocity", fastest, "velocity"), ("max_acceleration", hardest, "acceleration")]
    {
        let share = found / number(&limits[limit]);
        let claim = number(&example["certificate"][claim]);
        assert!(share <= claim && claim < share + 1e-6, "{share} {claim}");
    }
    for word in ["0.09375 rad", "0.46875 rad/s", "1.7361 rad/s²"] {
        assert!(REFERENCE.contains(word), "{word}");
    }
}

#[test]
fn every_verdict_section_and_kind_is_described() {
    let words = WORDS.lines().filter_map(|line| line.split_once("=> \"")?.1.split_once('"').map(|(word, _)| word));
    let words: Vec<&str> = words.collect();
    assert!(words.len() > 40, "the source has other words: {words:?}");
    let missing: Vec<_> = words.into_iter().filter(|word| !is_described(word)).collect();
    assert!(missing.is_empty(), "docs/path-file.md does not describe {missing:?}");
}
