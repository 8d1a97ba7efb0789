//! `foliate check` proves what holds along a segment besides who carries whom: balance, closed chains, distances, joints at
//! rest, objects on planes and on what others carry. Every promise is shown kept, and then broken by little.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so")]

#[path = "common/story.rs"]
mod story;

use serde_json::{Value, json};
use story::*;

const ALL: [bool; 6] = [true; 6];
const LEG: f64 = 0.5;
const HALF_STANCE: f64 = 0.1;

fn assert_only(folder: &Folder, path: &Value, kinds: &[&str]) {
    assert_eq!(folder.kinds(path), kinds, "{:#?}", folder.check(path).map(|r| r.violations));
}

/// A path of nothing but these parts and these segments.
fn alone(parts: Vec<Value>, coordinates: Vec<String>, segments: Vec<Value>) -> Value {
    let mut path = story();
    path["parts"] = Value::Array(parts);
    path["coordinates"] = json!(coordinates);
    path["limits"] = json!({});
    path["documents"] = json!({ "grippers": {}, "handles": {}, "surfaces": {} });
    path["segments"] = Value::Array(segments);
    // Most of these have no pair of shapes to test.
    path["certificate"]["min_clearance"] = json!(null);
    path
}

fn root_of(name: &str) -> Vec<String> {
    ["x", "y", "z", "qx", "qy", "qz", "qw"].map(|axis| format!("{name}/{axis}")).to_vec()
}

fn on(link: &str, pose: Pose) -> Value {
    json!({ "link": link, "pose": pose })
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    [x, y, z, 0.0, 0.0, 0.0, 1.0]
}

fn with(mut path: Value, constraints: Value) -> Value {
    path["segments"][0]["constraints"] = constraints;
    path
}

/// Everything that is of one kind, in one call: what must hold passes; each spoiled version is refused as `constraint`.
fn holds_but_not(folder: &Folder, path: &Value, entry: &Value, spoiled: &[(&str, Value)]) {
    let checked = with(path.clone(), json!([entry]));
    assert_only(folder, &checked, &[]);
    for (pointer, value) in spoiled {
        let mut checked = checked.clone();
        let entry = &mut checked["segments"][0]["constraints"][0];
        match entry.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => entry[pointer.trim_start_matches('/')] = value.clone(),
        }
        assert_eq!(folder.kinds(&checked), ["constraint"], "{pointer} {value}");
    }
}

mod on_two_feet {
    use super::*;

    /// A trunk on two legs of two links each: hips, knees and ankles turn about y.
    fn biped() -> String {
        let about_y = |joint: String| joint.replace("0 0 1\"/><parent", "0 1 0\"/><parent");
        let massless = |name: &str| format!(r#"<link name="{name}"/>"#);
        let mut elements = vec![link("trunk", "", 0.0)];
        for (side, y) in [("left", HALF_STANCE), ("right", -HALF_STANCE)] {
            let name = |what: &str| format!("{side}_{what}");
            let link_of = |what: &str| name(what);
            elements.extend([
                link(&link_of("thigh"), "", 0.0),
                massless(&link_of("shank")),
                link(&link_of("foot"), "", 0.0),
                about_y(joint(&name("hip"), "trunk", &link_of("thigh"), [0.0, y, 0.0], "")),
                about_y(joint(&name("knee"), &link_of("thigh"), &link_of("shank"), [0.0, 0.0, -LEG], "")),
                about_y(joint(&name("ankle"), &link_of("shank"), &link_of("foot"), [0.0, 0.0, -LEG], "")),
            ]);
        }
        robot(&elements)
    }

    fn coordinates() -> Vec<String> {
        let mut names = root_of("biped");
        for side in ["left", "right"] {
            names.extend(["hip", "knee", "ankle"].map(|joint| format!("biped/{side}_{joint}")));
        }
        names
    }

    fn height(bend: f64) -> f64 {
        2.0 * LEG * bend.cos()
    }

    /// Feet flat on the ground, knees bent by twice the angle: `bend` of either leg.
    fn stance(trunk: f64, left: f64, right: f64) -> Value {
        let mut row = at(0.0, 0.0, trunk).to_vec();
        for bend in [left, right] {
            row.extend([-bend, 2.0 * bend, -bend]);
        }
        json!(row)
    }

    /// Both knees bend from 0.2 to 0.6.
    fn crouch() -> Vec<Value> {
        let bends = (0..=80).map(|i| 0.2 + 0.005 * f64::from(i));
        bends.map(|bend| stance(height(bend), bend, bend)).collect()
    }

    fn path(knots: Vec<Value>) -> Value {
        let biped = part("biped", "robot", "freeflyer", IDENTITY);
        alone(vec![biped], coordinates(), vec![segment(json!([]), knots)])
    }

    fn folder() -> Folder {
        let folder = Folder::new();
        folder.write("biped.urdf", &biped());
        folder
    }

    fn foot(side: &str, mask: [bool; 6]) -> Value {
        let y = if side == "left" { HALF_STANCE } else { -HALF_STANCE };
        json!({ "kind": "pose", "name": format!("{side} foot stands"), "frame": format!("biped/{side}_foot"), "to": "world",
                "mask": mask, "value": at(0.0, y, 0.0), "tolerance": 2e-4 })
    }

    #[test]
    fn feet_stay_where_they_stand() {
        let folder = folder();
        let good = with(path(crouch()), json!([foot("left", [true; 6]), foot("right", [true; 6])]));
        assert_only(&folder, &good, &[]);
        // A knot in which a foot has slipped by a millimetre.
        let mut slipped = good.clone();
        slipped["segments"][0]["knots"][40][0] = json!(1e-3);
        assert_only(&folder, &slipped, &["constraint"]);
        // A foot that tilts while it stays where it is.
        let mut tilted = good.clone();
        tilted["segments"][0]["knots"][40][12] = json!(-0.401);
        assert_only(&folder, &tilted, &["constraint"]);
        assert_eq!(folder.subject(&tilted), "right foot stands (pose of biped/right_foot in world): rotation");
        // Knots too far apart: all of them stand, what is between does not.
        let mut coarse = good;
        coarse["segments"][0]["knots"] = json!([crouch()[0], crouch()[80]]);
        assert_only(&folder, &coarse, &["constraint"]);
    }

    #[test]
    fn feet_that_slide_together_keep_their_distance() {
        let folder = folder();
        let knots: Vec<Value> = crouch()
            .into_iter()
            .enumerate()
            .map(|(i, mut knot)| {
                knot[0] = json!(0.01 * i as f64);
                knot
            })
            .collect();
        let flat = foot("left", [false, false, true, true, true, false]);
        let together = json!({ "kind": "pose", "frame": "biped/right_foot", "to": "biped/left_foot", "mask": ALL,
                               "tolerance": 2e-4 });
        let good = with(path(knots), json!([flat, together]));
        assert_only(&folder, &good, &[]);
        let mut apart = good;
        apart["segments"][0]["knots"][40][11] = json!(0.82);
        assert_only(&folder, &apart, &["constraint"]);
    }

    #[test]
    fn a_knee_does_not_jump_to_its_other_branch() {
        let folder = folder();
        let feet = json!([foot("left", [true; 6]), foot("right", [true; 6])]);
        let jump =
            |to: f64| with(path(vec![stance(height(0.4), 0.4, 0.4), stance(height(0.4), 0.4, to)]), feet.clone());
        // Both knots stand on both feet; the knee goes from bent forwards to bent backwards.
        assert_only(&folder, &jump(0.4), &[]);
        let found = folder.check(&jump(-0.4)).unwrap();
        assert!(
            found.violations.iter().all(|v| v.kind.name() == "constraint" && v.t.is_some_and(|t| 0.0 < t && t < 1.0))
        );
        assert!(found.violations.iter().any(|v| v.subject.contains("right foot") && v.value.unwrap() > 0.05));
        // However small the jump is: the residual between the knots decides.
        for angle in [0.1, 0.03] {
            let knots = vec![stance(height(angle), angle, angle), stance(height(angle), angle, -angle)];
            assert_only(&folder, &with(path(knots), feet.clone()), &["constraint"]);
        }
        // Less than the tolerance it is no jump: a centimetre's fraction of a bend lifts the foot by 0.08 mm.
        let knots = vec![stance(height(0.0126), 0.0126, 0.0126), stance(height(0.0126), 0.0126, -0.0126)];
        assert_only(&folder, &with(path(knots), feet.clone()), &[]);
    }

    #[test]
    fn a_centre_of_mass_is_summed_up_from_the_links() {
        let folder = folder();
        // Trunk and thighs have their kilograms at the hips' height, the feet theirs on the ground.
        let centre = json!({ "kind": "centre_of_mass", "name": "balance", "parts": ["biped"], "to": "biped/left_foot",
                             "mask": [true, true, false, false, false, false],
                             "value": at(0.0, -HALF_STANCE, 0.0), "tolerance": 2e-4 });
        let off = |x: f64, y: f64| ("/value", json!(at(x, y, 0.0)));
        holds_but_not(&folder, &path(crouch()), &centre, &[off(2e-3, -HALF_STANCE), off(0.0, -HALF_STANCE - 2e-3)]);
        let still = path(vec![stance(height(0.5), 0.5, 0.5); 2]);
        let mut all = centre;
        all["mask"] = json!([true, true, true, false, false, false]);
        all["value"] = json!(at(0.0, -HALF_STANCE, 0.6 * height(0.5)));
        let lifted = at(0.0, -HALF_STANCE, 0.6 * height(0.5) + 2e-3);
        holds_but_not(&folder, &still, &all, &[("/value", json!(lifted))]);
        // Without a value the first knot is the reference, and the crouch lowers it.
        all["value"] = json!(null);
        assert_only(&folder, &with(path(crouch()), json!([all])), &["constraint"]);
    }

    #[test]
    fn a_centre_of_mass_stays_on_its_side_of_planes() {
        let folder = folder();
        let plane = |normal: [f64; 3], offset: f64, inequality: bool| json!({ "normal": normal, "offset": offset, "inequality": inequality });
        let lowest = 0.6 * height(0.6);
        let planes = json!([
            plane([1.0, 0.0, 0.0], 0.0, false),
            plane([0.0, 0.0, 1.0], lowest - 1e-4, true),
            plane([0.0, -1.0, 0.0], -0.2, true)
        ]);
        let centre =
            json!({ "kind": "centre_of_mass", "parts": ["biped"], "to": "world", "planes": planes, "tolerance": 2e-4 });
        let spoiled = [
            ("/planes/0/offset", json!(2e-3)),
            ("/planes/1/offset", json!(lowest + 1e-3)),
            ("/planes/1/inequality", json!(false)),
            ("/planes/2/offset", json!(2e-3)),
        ];
        holds_but_not(&folder, &path(crouch()), &centre, &spoiled);
    }

    #[test]
    fn a_centre_of_mass_is_over_the_line_between_the_feet() {
        let folder = folder();
        let balance = json!({ "kind": "centre_of_mass_between", "parts": ["biped"], "frame": "biped/left_foot",
                              "to": "biped/right_foot", "tolerance": 2e-4 });
        let beside = on("biped/left_foot", at(0.01, 0.0, 0.0));
        let within = on("biped/left_foot", at(0.0, -0.11, 0.0));
        let before = on("biped/right_foot", at(0.0, 0.11, 0.0));
        let one_point = json!("biped/right_foot");
        let spoiled =
            [("/frame", beside), ("/frame", within), ("/to", before), ("/frame", one_point), ("/height", json!(0.55))];
        holds_but_not(&folder, &path(crouch()), &balance, &spoiled);
        let mut high = balance;
        high["height"] = json!(0.6 * height(0.3));
        holds_but_not(&folder, &path(vec![stance(height(0.3), 0.3, 0.3); 2]), &high, &[("/height", json!(0.575))]);
    }

    /// Numbers in [-1, 1), the same in every run.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// Between two rows as the contract plays them: the root on the quaternion geodesic, everything else linearly.
    fn between(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
        let mut row: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
        let dot: f64 = (3..7).map(|i| a[i] * b[i]).sum();
        let angle = dot.clamp(-1.0, 1.0).acos();
        let (from, to) = (((1.0 - share) * angle).sin() / angle.sin(), (share * angle).sin() / angle.sin());
        (3..7).for_each(|i| row[i] = from * a[i] + to * b[i]);
        let norm = (3..7).map(|i| row[i] * row[i]).sum::<f64>().sqrt();
        (3..7).for_each(|i| row[i] /= norm);
        row
    }

    #[test]
    fn what_holds_between_two_knots_is_neither_more_nor_less_than_what_is_proved() {
        // The largest error of a motion, from many samples: held to a little more it passes, to a little less not,
        // wherever between the two knots it is.
        let folder = folder();
        let mut numbers = Numbers(7);
        let axis = [false, false, false, true, true, false];
        let rows = |mask: [bool; 6]| {
            json!({ "kind": "pose", "frame": on("biped/right_foot", at(0.1, 0.2, -0.3)),
                                            "to": on("biped/left_foot", about_z(0.2, 0.0, 0.1, 0.4)), "mask": mask })
        };
        let feet = json!({ "kind": "centre_of_mass_between", "parts": ["biped"], "frame": "biped/left_foot",
                           "to": "biped/right_foot", "height": 0.3 });
        let plane = json!([{ "normal": [0.6, 0.0, 0.8], "offset": 0.4, "inequality": true }]);
        let entries = [
            rows([true, true, true, false, false, false]),
            rows([false, true, false, false, false, false]),
            rows([false, false, false, true, true, true]),
            rows(axis),
            json!({ "kind": "pose", "frame": "world", "to": "biped/right_foot", "mask": [true, true, true, false, false, false] }),
            json!({ "kind": "distance", "frame": "biped/right_foot", "to": "world", "length": 0.5 }),
            json!({ "kind": "distance", "frame": "biped/left_thigh", "to": "biped/right_foot", "length": 1.1, "bound": "at_least" }),
            json!({ "kind": "centre_of_mass", "parts": ["biped"], "to": "biped/right_foot", "mask": [true, true, true, false, false, false] }),
            json!({ "kind": "centre_of_mass", "parts": ["biped"], "to": "world", "planes": plane }),
            feet,
        ];
        for entry in &entries {
            for _ in 0..3 {
                let mut random = || -> Vec<f64> {
                    let mut row: Vec<f64> = (0..13).map(|_| 0.7 * numbers.next()).collect();
                    row[6] = 1.5;
                    let norm = row[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
                    row[3..7].iter_mut().for_each(|x| *x /= norm);
                    row
                };
                let (a, b) = (random(), random());
                let held = |knots: Vec<Value>, tolerance: f64| {
                    let mut entry = entry.clone();
                    entry["tolerance"] = json!(tolerance);
                    folder.check(&with(path(knots), json!([entry]))).unwrap()
                };
                let many = (0..=4000).map(|i| json!(between(&a, &b, f64::from(i) / 4000.0))).collect();
                let largest = held(many, 1e5).max_residual.unwrap().value;
                let two = || vec![json!(a), json!(b)];
                let (more, less) =
                    (held(two(), 1.001 * largest + 1e-9), held(two(), (0.999 * largest - 1e-9).max(0.0)));
                assert!(more.passed(), "{entry} {largest}: {:#?}", more.violations);
                assert!(largest < 1e-8 || !less.passed(), "{entry} {largest}");
            }
        }
    }

    #[test]
    fn who_leans_between_two_upright_knots_is_seen() {
        // The trunk goes from over the left foot to over the right one, on a bow that both knots do not show.
        let folder = folder();
        let turned = |angle: f64| {
            let mut row = stance(height(0.3), 0.3, 0.3);
            let quaternion = about_z(0.0, 0.0, 0.0, angle);
            (3..7).for_each(|i| row[i] = json!(quaternion[i]));
            row
        };
        let centre = json!({ "kind": "centre_of_mass", "parts": ["biped"], "to": on("world", about_z(0.0, 0.0, 0.0, 0.2)),
                             "mask": [true, true, false, false, false, false], "value": at(0.0, 0.0, 0.0),
                             "tolerance": 2e-4 });
        assert_only(&folder, &with(path(vec![turned(0.0), turned(3.0)]), json!([centre])), &[]);
        let mut row = turned(1.0);
        row[0] = json!(0.01);
        let mut back = turned(0.0);
        back[0] = json!(-0.01);
        // At the middle it is where it should be; a sampler that looks there only would be content.
        assert_only(&folder, &with(path(vec![row, back]), json!([centre])), &["constraint"]);
    }
}

mod distances_and_joints {
    use super::*;

    /// The arm alone turns its shoulder.
    fn turning(shoulder: [f64; 2], elbow: [f64; 2]) -> Value {
        let full = story();
        let names = vec!["arm/shoulder".to_owned(), "arm/elbow".to_owned()];
        let knots = vec![json!([shoulder[0], elbow[0]]), json!([shoulder[1], elbow[1]])];
        alone(vec![full["parts"][0].clone()], names, vec![segment(json!([]), knots)])
    }

    fn apart(length: f64, bound: &str) -> Value {
        json!({ "kind": "distance", "frame": on("arm/lower", at(0.5, 0.0, 0.0)), "to": on("world", at(0.0, 0.0, 0.5)),
                "length": length, "bound": bound, "tolerance": 2e-4 })
    }

    #[test]
    fn two_points_stay_apart() {
        let folder = Folder::new();
        let swing = turning([-1.0, 1.2], [0.0, 0.0]);
        holds_but_not(&folder, &swing, &apart(1.0, "equal"), &[("/length", json!(1.001))]);
        holds_but_not(&folder, &swing, &apart(0.9, "at_least"), &[("/length", json!(1.001))]);
        holds_but_not(&folder, &swing, &apart(1.1, "at_most"), &[("/length", json!(0.999))]);
        // An elbow that goes from one side to the other stretches the arm in between.
        let through = turning([0.0, 0.0], [-1.0, 1.0]);
        let ends = 2.0 * 0.5 * 0.5_f64.cos();
        holds_but_not(
            &folder,
            &through,
            &apart(1.0, "at_most"),
            &[("/bound", json!("equal")), ("/length", json!(ends))],
        );
        holds_but_not(&folder, &through, &apart(ends, "at_least"), &[("/bound", json!("at_most"))]);
        // Without a length the first knot's counts.
        let mut first = apart(0.0, "equal");
        first["length"] = json!(null);
        holds_but_not(&folder, &swing, &first, &[("/length", json!(0.99))]);
    }

    #[test]
    fn a_joint_rests() {
        let folder = Folder::new();
        let rest = json!({ "kind": "joint", "joint": "arm/elbow", "position": 0.3, "tolerance": 1e-6 });
        let still = turning([0.0, 1.0], [0.3, 0.3]);
        holds_but_not(&folder, &still, &rest, &[("/position", json!(0.301))]);
        let mut first = rest;
        first["position"] = json!(null);
        assert_only(&folder, &with(turning([0.0, 1.0], [0.3, 0.31]), json!([first])), &["constraint"]);
    }

    #[test]
    fn rows_that_must_not_be_negative() {
        let folder = Folder::new();
        // The tip stays beyond x = 0.6, in the axes of the value, which is turned.
        let mask = [true, false, false, false, false, false];
        let beyond = |x: f64| {
            json!({ "kind": "pose", "frame": on("arm/lower", at(0.5, 0.0, 0.0)), "to": "world", "mask": mask,
                    "inequality": mask, "value": about_z(x * 0.3_f64.cos(), x * 0.3_f64.sin(), 0.0, 0.3), "tolerance": 2e-4 })
        };
        let swing = turning([-0.4, 1.0], [0.0, 0.0]);
        let least = 0.7_f64.cos();
        let path = |entry: Value| with(swing.clone(), json!([entry]));
        assert_only(&folder, &path(beyond(least)), &[]);
        assert_only(&folder, &path(beyond(least + 1e-3)), &["constraint"]);
        let mut turned = beyond(0.5);
        (turned["mask"], turned["inequality"]) = (json!(ALL), json!([false, false, false, true, false, false]));
        assert_only(&folder, &path(turned), &["unchecked-constraint"]);
    }

    #[test]
    fn an_elbow_does_not_flip_while_the_tip_is_held() {
        let folder = Folder::new();
        let tip = json!({ "kind": "pose", "frame": "arm/hand", "to": "world", "mask": [true, true, true, false, false, false],
                          "value": at(0.5_f64.cos(), 0.0, 0.5), "tolerance": 2e-4 });
        let held = |elbow: f64| with(turning([-0.5, -0.5 * elbow.signum()], [1.0, elbow]), json!([tip]));
        let documents = story()["documents"]["grippers"].clone();
        let check = |mut path: Value| {
            path["documents"]["grippers"] = documents.clone();
            folder.kinds(&path)
        };
        assert_eq!(check(held(1.0)), [""; 0]);
        assert_eq!(check(held(-1.0)), ["constraint"]);
    }

    #[test]
    fn a_function_of_the_program_is_told_to_be_unproved() {
        let folder = Folder::new();
        let own = json!({ "kind": "custom", "name": "gaze", "tolerance": 2e-4 });
        let path = with(turning([0.0, 1.0], [0.0, 0.0]), json!([own]));
        assert_only(&folder, &path, &["unchecked-constraint"]);
        assert_eq!(folder.subject(&path), "gaze (custom): a function of the program's own, not proved here");
    }

    #[test]
    fn what_is_no_constraint_is_refused_with_its_place() {
        let folder = Folder::new();
        let still = turning([0.0, 1.0], [0.0, 0.0]);
        let cases = [
            (json!({ "kind": "pose", "frame": "arm", "to": "world", "tolerance": 1e-4 }), "constraints[0].mask"),
            (json!({ "kind": "pose", "to": "world", "mask": ALL, "tolerance": 1e-4 }), "constraints[0].frame"),
            (
                json!({ "kind": "distance", "frame": "arm/thumb", "to": "world", "tolerance": 1e-4 }),
                "constraints[0].frame",
            ),
            (
                json!({ "kind": "distance", "frame": { "link": "arm/lower", "pose": [0, 0, 0, 0, 0, 0, 2] }, "to": "world", "tolerance": 1e-4 }),
                "constraints[0].frame.pose",
            ),
            (
                json!({ "kind": "distance", "frame": "arm", "to": "world", "bound": "often", "tolerance": 1e-4 }),
                "constraints[0].bound",
            ),
            (json!({ "kind": "joint", "joint": "arm/wrist", "tolerance": 1e-4 }), "constraints[0].joint"),
            (json!({ "kind": "joint", "tolerance": 1e-4 }), "constraints[0].joint"),
            (
                json!({ "kind": "joint", "joint": "arm/elbow", "position": 1e300, "tolerance": 1e-4 }),
                "constraints[0].position",
            ),
            (
                json!({ "kind": "centre_of_mass", "parts": ["leg"], "to": "world", "tolerance": 1e-4 }),
                "constraints[0].parts",
            ),
            (
                json!({ "kind": "centre_of_mass", "parts": ["arm", "arm"], "to": "world", "tolerance": 1e-4 }),
                "constraints[0].parts[1]",
            ),
            (
                json!({ "kind": "centre_of_mass", "parts": ["arm"], "to": "world", "tolerance": 1e-4, "planes": [{ "normal": [1, 1, 0], "offset": 0 }] }),
                "planes[0].normal",
            ),
            (
                json!({ "kind": "centre_of_mass_between", "parts": ["arm"], "frame": "arm", "tolerance": 1e-4 }),
                "constraints[0].to",
            ),
            (json!({ "kind": "joint", "joint": "arm/elbow", "tolerance": -1.0 }), "constraints[0].tolerance"),
            (
                json!({ "kind": "pose", "frame": "arm", "to": "world", "mask": [false, true, true, true, true, true], "inequality": [true, false, false, false, false, false], "tolerance": 1e-4 }),
                "constraints[0].inequality",
            ),
        ];
        for (entry, place) in cases {
            let refused = folder.check(&with(still.clone(), json!([entry]))).expect_err(place);
            assert!(refused.contains(place), "{place}: {refused}");
        }
    }
}

mod objects {
    use super::*;

    #[test]
    fn an_object_stands_on_a_plane() {
        let folder = Folder::new();
        let start = in_hand(0.0, 0.0);
        let mut path = story();
        path["segments"] = json!([segment(json!([]), vec![knot(0.0, -0.6, start), knot(0.0, 0.0, start)])]);
        let standing = json!({ "kind": "pose", "name": "place_cube", "frame": on("cube/cube", at(0.0, 0.0, -0.02)),
                               "to": on("world", about_z(0.3, -0.2, 0.48, 0.7)),
                               "mask": [false, false, true, true, true, false], "value": IDENTITY, "tolerance": 2e-4 });
        let tilted = [0.3, -0.2, 0.48, 0.005_f64.sin(), 0.0, 0.0, 0.005_f64.cos()];
        let lower = ("/to/pose", json!(about_z(0.3, -0.2, 0.479, 0.7)));
        let foot = ("/frame/pose", json!(at(0.0, 0.0, -0.021)));
        holds_but_not(&folder, &path, &standing, &[lower, foot]);
        let mut askew = with(path.clone(), json!([standing]));
        askew["segments"][0]["constraints"][0]["to"]["pose"] = json!(tilted);
        assert_only(&folder, &askew, &["constraint"]);
        // It must not slide on it either.
        let mut slid = with(path, json!([standing]));
        slid["segments"][0]["knots"][1][2] = json!(start[0] + 1e-3);
        assert_only(&folder, &slid, &["unattached-object-moved"]);
    }

    #[test]
    fn what_rests_on_a_link_touches_it_and_stays() {
        let folder = Folder::new();
        let start = in_hand(0.0, 0.0);
        let mut path = story();
        path["certificate"]["min_clearance"] = json!(0.0);
        path["margins"] = json!([["cube/cube", "table/top", 0.01]]);
        path["segments"] = json!([segment(json!([]), vec![knot(0.0, -0.6, start), knot(0.0, -0.3, start)])]);
        assert_only(&folder, &path, &["margin"]);
        path["segments"][0]["attachments"] = json!([{ "object": "cube", "on": "table/top", "carrier": true }]);
        // Nothing says how it rests: it might hang on the table's side.
        assert_only(&folder, &path, &["placement"]);
        path["segments"][0]["constraints"] = json!([{
            "kind": "pose", "frame": on("cube/cube", at(0.0, 0.0, -0.02)), "to": on("world", at(0.0, 0.0, 0.48)),
            "mask": [false, false, true, true, true, false], "value": IDENTITY, "tolerance": 2e-4,
        }]);
        assert_only(&folder, &path, &[]);
        // What moves carries nothing without a hold on it.
        let mut glued = path.clone();
        glued["segments"][0]["attachments"][0]["on"] = json!("arm/lower");
        assert!(folder.kinds(&glued).contains(&"placement"));
        let mut slid = path.clone();
        slid["segments"][0]["knots"][1][2] = json!(start[0] + 1e-3);
        assert_only(&folder, &slid, &["placed-object-moved"]);
        path["segments"][0]["attachments"][0]["on"] = json!("table/cloth");
        assert!(folder.check(&path).unwrap_err().contains("segments[0].attachments[0].on"));
    }

    /// The hand holds the cube by a point, about which it turns on its own: nothing carries it, and it is written as it goes.
    #[test]
    fn what_is_held_by_a_point_moves_as_written() {
        let folder = Folder::new();
        let mut path = story();
        let three = [true, true, true, false, false, false];
        path["documents"]["handles"]["cube/handle"]["mask"] = json!(three);
        let turned = |shoulder: f64, turn: f64| {
            let [x, y, z, ..] = in_hand(shoulder, 0.0);
            knot(shoulder, 0.0, about_z(x, y, z, turn))
        };
        let mut free = held();
        free["carrier"] = json!(false);
        path["segments"] = json!([segment(json!([free]), vec![turned(0.0, 0.0), turned(0.02, 0.5)])]);
        assert_only(&folder, &path, &[]);
        let mut torn = path.clone();
        torn["segments"][0]["knots"][1][2] = json!(in_hand(0.02, 0.0)[0] + 1e-3);
        assert_only(&folder, &torn, &["grasp"]);
        // On an arc of which the chord is too far off.
        let mut wide = path.clone();
        wide["segments"][0]["knots"][1] = turned(0.1, 0.5);
        assert_only(&folder, &wide, &["grasp"]);
        // What is not held at all stays.
        path["segments"][0]["attachments"] = json!([]);
        assert_only(&folder, &path, &["unattached-object-moved"]);
    }

    const TRAY_TO_CUBE: f64 = 0.031;

    /// The story's arm carries a tray on which the cube stands.
    fn tray() -> (Folder, Value) {
        let folder = Folder::new();
        folder.write("tray.urdf", &robot(&[link("tray", &cuboid(0.08, 0.08, 0.02), 0.0)]));
        let full = story();
        let parts = vec![
            full["parts"][0].clone(),
            full["parts"][1].clone(),
            full["parts"][2].clone(),
            part("tray", "object", "freeflyer", IDENTITY),
        ];
        let row = |shoulder: f64| {
            let tip = in_hand(shoulder, 0.0);
            let mut cube = tip;
            cube[2] += TRAY_TO_CUBE;
            let numbers: Vec<f64> = [shoulder, 0.0].into_iter().chain(cube).chain(tip).collect();
            json!(numbers)
        };
        let mut coordinates: Vec<String> = vec!["arm/shoulder".into(), "arm/elbow".into()];
        coordinates.extend(root_of("cube"));
        coordinates.extend(root_of("tray"));
        let attachments = json!([
            { "object": "cube", "surface": "cube/bottom", "support": "tray/top", "carrier": true },
            { "object": "tray", "gripper": "arm/hand", "handle": "tray/handle", "carrier": true },
        ]);
        let mut path = alone(parts, coordinates, vec![segment(attachments, vec![row(0.0), row(0.4)])]);
        path["documents"] = full["documents"].clone();
        let mut handle = full["documents"]["handles"]["cube/handle"].clone();
        handle["link"] = json!("tray/tray");
        path["documents"]["handles"]["tray/handle"] = handle;
        let corner = |x: f64, y: f64| [0.04 * x, 0.04 * y, 0.01];
        path["documents"]["surfaces"]["tray/top"] = json!({
            "link": "tray/tray", "polygons": [[0, 1, 2, 3]],
            "points": [corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)],
        });
        (folder, path)
    }

    #[test]
    fn a_cube_rides_on_a_tray() {
        let (folder, path) = tray();
        assert_only(&folder, &path, &[]);
        // It slides on the tray.
        let mut slid = path.clone();
        slid["segments"][0]["knots"][1][2] = json!(path["segments"][0]["knots"][1][2].as_f64().unwrap() + 1e-3);
        assert_only(&folder, &slid, &["placed-object-moved"]);
        // It is said to lie on the table, on which it does not lie.
        let mut swapped = path.clone();
        swapped["segments"][0]["attachments"][0]["support"] = json!("table/top");
        let kinds = folder.kinds(&swapped);
        assert!(kinds.contains(&"placement") && kinds.contains(&"placed-object-moved"), "{kinds:?}");
        // It floats above the tray.
        let mut floating = path;
        for knot in floating["segments"][0]["knots"].as_array_mut().unwrap() {
            knot[4] = json!(knot[4].as_f64().unwrap() + 1e-3);
        }
        assert_only(&folder, &floating, &["placement"]);
    }

    #[test]
    fn a_gripper_sits_on_an_object() {
        let (folder, mut path) = tray();
        path["documents"]["grippers"]["tray/magnet"] =
            json!({ "link": "tray/tray", "link_from_gripper": at(0.0, 0.0, TRAY_TO_CUBE) });
        path["segments"][0]["attachments"][0] =
            json!({ "object": "cube", "gripper": "tray/magnet", "handle": "cube/handle", "carrier": true });
        assert_only(&folder, &path, &[]);
        path["documents"]["grippers"]["tray/magnet"]["link_from_gripper"][2] = json!(TRAY_TO_CUBE + 1e-3);
        assert_only(&folder, &path, &["grasp"]);
    }

    /// A door whose hinge is under the arm's shoulder, with its handle at the arm's tip.
    fn door() -> (Folder, Value) {
        let folder = Folder::new();
        let hinge = joint("hinge", "frame", "leaf", [0.0, 0.0, 0.5], "");
        folder.write("door.urdf", &robot(&[link("frame", "", 0.0), link("leaf", "", 0.0), hinge]));
        let full = story();
        let parts = vec![full["parts"][0].clone(), part("door", "object", "fixed", IDENTITY)];
        let names = ["arm/shoulder", "arm/elbow", "door/hinge"].map(str::to_owned).to_vec();
        let held = json!([{ "object": "door/leaf", "gripper": "arm/hand", "handle": "door/handle", "carrier": false }]);
        let row = |shoulder: f64, elbow: f64, hinge: f64| json!([shoulder, elbow, hinge]);
        let segments = vec![
            segment(json!([]), vec![row(0.0, -0.6, 0.0), row(0.0, 0.0, 0.0)]),
            segment(held, vec![row(0.0, 0.0, 0.0), row(0.7, 0.0, 0.7)]),
            segment(json!([]), vec![row(0.7, 0.0, 0.7), row(0.7, -0.6, 0.7)]),
        ];
        let mut path = alone(parts, names, segments);
        path["documents"]["grippers"] = full["documents"]["grippers"].clone();
        let mut handle = full["documents"]["handles"]["cube/handle"].clone();
        (handle["link"], handle["link_from_handle"]) = (json!("door/leaf"), json!(at(1.0, 0.0, 0.0)));
        path["documents"]["handles"]["door/handle"] = handle;
        (folder, path)
    }

    #[test]
    fn a_door_moves_only_while_it_is_held() {
        let (folder, path) = door();
        assert_only(&folder, &path, &[]);
        // It opens by a degree by itself.
        let mut haunted = path.clone();
        haunted["segments"][2]["knots"][1][2] = json!(0.7 + 1.0_f64.to_radians());
        assert_only(&folder, &haunted, &["joint-unheld"]);
        assert_eq!(folder.subject(&haunted), "door/hinge");
        // No gripper holds it.
        let mut unheld = path.clone();
        unheld["segments"][1]["attachments"] = json!([]);
        assert_only(&folder, &unheld, &["joint-unheld"]);
        // Held by its frame it is not held beyond the hinge; and the frame is not where the hand is.
        let mut frame = path.clone();
        frame["documents"]["handles"]["door/handle"]["link"] = json!("door/frame");
        frame["segments"][1]["attachments"][0]["object"] = json!("door");
        assert!(folder.kinds(&frame).contains(&"joint-unheld"));
        // The hand leaves the handle behind.
        let mut slips = path.clone();
        slips["segments"][1]["knots"][1][2] = json!(0.701);
        slips["segments"][2]["knots"] = json!([[0.7, 0.0, 0.701], [0.7, -0.6, 0.701]]);
        assert_only(&folder, &slips, &["grasp"]);
        // It should be shut while no gripper holds it.
        let shut = json!([{ "kind": "joint", "name": "door shut", "joint": "door/hinge", "position": 0.0, "tolerance": 2e-4 }]);
        let mut ajar = path;
        ajar["segments"][0]["constraints"] = shut.clone();
        assert_only(&folder, &ajar, &[]);
        ajar["segments"][2]["constraints"] = shut;
        assert_only(&folder, &ajar, &["constraint"]);
    }
}
