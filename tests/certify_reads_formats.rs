//! Motions as others write them are read for what they mean, and what is wrong with a file is said with its place and the way out.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod certify_common;

use certify_common::{ball, cuboid, folder, joint, link, scene};
use foliate::certify::formats::{Format, ReadOptions, read, read_bytes};
use foliate::certify::{Curve, Interpolation, Motion, Turns};
use foliate::components::problem::Problem;
use std::io::Write;

/// A mobile base with two arms; a finger mimics another; the wrist turns without limits.
fn robot() -> Problem {
    let robot = link("base", "", [0.0; 3])
        + &link("upper", &cuboid(0.1, 0.1, 0.1), [0.0; 3])
        + &link("wrist", &ball(0.05), [0.0; 3])
        + &link("finger", "", [0.0; 3])
        + &link("other", "", [0.0; 3])
        + &joint("shoulder", "revolute", "0 0 1", "base", "upper", 0.5)
        + &joint("turn", "continuous", "0 0 1", "upper", "wrist", 0.5)
        + &joint("left_finger", "prismatic", "1 0 0", "wrist", "finger", 0.1)
        + &joint("right_finger", "prismatic", "1 0 0", "wrist", "other", 0.1)
            .replace("</joint>", r#"<mimic joint="left_finger" multiplier="-1" offset="0.5"/></joint>"#);
    let flyer = link("hull", &ball(0.1), [0.0; 3]);
    let start = "[start]\nrobot = [0.0, 0.0, 0.0]\nload = { xyz = [0.0, 5.0, 0.0] }\n[[goal]]\n\
                 configuration = { \"robot/shoulder\" = 0.5 }\n";
    scene(&[("robot", "robot", "root = \"planar\"", robot), ("load", "object", "root = \"freeflyer\"", flyer)], start)
}

fn try_read(text: impl Into<Vec<u8>>, options: &ReadOptions) -> Result<Motion, String> {
    read_bytes("file", text.into(), &robot().robot, options).map_err(|e| e.to_string())
}

fn motion(text: impl Into<Vec<u8>>) -> Motion {
    try_read(text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn refusal(text: impl Into<Vec<u8>>) -> String {
    try_read(text, &ReadOptions::default()).expect_err("it is refused")
}

/// Values of coordinates by name at a time.
fn at(motion: &Motion, time: f64, names: &[&str]) -> Vec<f64> {
    let problem = robot();
    let mut q = problem.start.clone();
    motion.write(motion.place(time), &mut q);
    let index = |name: &&str| q[foliate::certify::find_coordinate(&problem.robot, name).unwrap()];
    names.iter().map(index).collect()
}

fn near(found: &[f64], wanted: &[f64]) {
    assert_eq!(found.len(), wanted.len());
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {wanted:?}");
}

const JOINTS: [&str; 2] = ["robot/shoulder", "robot/turn"];

#[test]
fn tables_with_a_header() {
    for text in [
        "time,shoulder,robot/turn\n0,0.5,1\n2,1.5,-1\n",
        "# t;robot/turn;shoulder\n0;1;0.5\n\n2;-1;1.5\n",
        "\"time_from_start\"\tshoulder\tturn.position\r\n0\t0.5\t1\r\n2\t1.5\t-1\r\n",
    ] {
        let motion = motion(text);
        assert!(motion.timed && motion.degree() == 1, "{text}");
        near(&at(&motion, 0.5, &JOINTS), &[0.75, 0.5]);
        assert_eq!((motion.starts(), motion.ends()), (0.0, 2.0));
    }
    let untimed = motion("shoulder,turn\n0,0\n1,1\n1,2\n");
    assert!(!untimed.timed);
    near(&at(&untimed, 1.5, &JOINTS), &[1.0, 1.5]);
    let cubic = motion("t,shoulder,shoulder.velocity\n0,0,0\n2,1,0\n");
    assert_eq!(cubic.degree(), 3);
    near(&at(&cubic, 0.5, &["robot/shoulder"]), &[3.0 / 16.0 - 2.0 / 64.0]);
    let base = motion("robot/x,robot/theta\n0,0\n1,3\n");
    near(&at(&base, 0.5, &["robot/x", "robot/theta"]), &[0.5, 1.5]);
}

#[test]
fn messages_of_ros() {
    let points = |time: &dyn Fn(u32) -> String| {
        format!(
            r#"{{"header": {{"frame_id": "world"}}, "joint_names": ["turn", "shoulder"], "points": [
            {{"positions": [0, 0], "velocities": [0, 0], "accelerations": [], "effort": [], "time_from_start": {}}},
            {{"positions": [1, 2], "velocities": [0, 0], "accelerations": [], "effort": [], "time_from_start": {}}}]}}"#,
            time(0),
            time(2)
        )
    };
    let times: [&dyn Fn(u32) -> String; 4] = [
        &|t| format!(r#"{{"sec": {t}, "nanosec": 500000000}}"#),
        &|t| format!(r#"{{"secs": {t}, "nsecs": 500000000}}"#),
        &|t| format!("{t}.5"),
        &|t| format!("{}", f64::from(t) + 0.5),
    ];
    for time in times {
        let text = points(time);
        let wrapped = [
            text.clone(),
            format!(
                r#"{{"joint_trajectory": {text}, "multi_dof_joint_trajectory": {{"joint_names": [], "points": []}}}}"#
            ),
            format!(
                r#"{{"model_id": "x", "trajectory": [{{"joint_trajectory": {text}}}], "trajectory_start":
                {{"joint_state": {{"name": ["left_finger", "shoulder"], "position": [0.25, 9]}}}}}}"#
            ),
            format!(r#"{{"motion_plan_response": {{"trajectory": {{"joint_trajectory": {text}}}}}}}"#),
        ];
        for text in wrapped {
            let motion = motion(text.as_str());
            assert_eq!((motion.starts(), motion.ends(), motion.degree()), (0.5, 2.5, 3), "{text}");
            near(&at(&motion, 1.0, &JOINTS), &[2.0 * (3.0 / 16.0 - 2.0 / 64.0), 3.0 / 16.0 - 2.0 / 64.0]);
        }
    }
    let start = motion(format!(
        r#"{{"trajectory": [{{"joint_trajectory": {}}}], "trajectory_start": {{"joint_state":
        {{"name": ["left_finger", "unknown"], "position": [0.25, 1]}}}}}}"#,
        points(times[2])
    ));
    assert_eq!(start.start.len(), 1);
    assert_eq!(start.start[0].1, 0.25);
}

#[test]
fn trajectories_in_a_row_are_joined() {
    let one = |a: f64, b: f64| {
        format!(
            r#"{{"joint_trajectory": {{"joint_names": ["shoulder"], "points": [
            {{"positions": [{a}], "time_from_start": 0.0}}, {{"positions": [{b}], "time_from_start": 1.0}}]}}}}"#
        )
    };
    let motion = motion(format!(r#"{{"trajectory": [{}, {}]}}"#, one(0.0, 1.0), one(1.0, 3.0)));
    assert_eq!((motion.segments.len(), motion.ends()), (2, 2.0));
    near(&at(&motion, 1.5, &["robot/shoulder"]), &[2.0]);
}

#[test]
fn bases_that_drive() {
    let turned =
        |angle: f64| format!(r#"{{"x": 0, "y": 0, "z": {}, "w": {}}}"#, (angle / 2.0).sin(), (angle / 2.0).cos());
    let point = |x: f64, angle: f64, time: f64| {
        format!(
            r#"{{"transforms": [{{"translation": {{"x": {x}, "y": 0, "z": 0}}, "rotation": {}}}], "time_from_start": {time}}}"#,
            turned(angle)
        )
    };
    // Past half a turn the angle goes on.
    let points = [point(0.0, 2.0, 0.0), point(1.0, 3.0, 1.0), point(1.0, -2.5, 2.0)].join(",");
    let joints = r#"{"joint_names": ["shoulder"], "points": [{"positions": [0], "velocities": [0], "time_from_start": 0.0},
        {"positions": [1], "velocities": [0], "time_from_start": 1.0}, {"positions": [1], "velocities": [0], "time_from_start": 2.0}]}"#;
    for name in ["robot", "robot/root_joint", "world_joint"] {
        let motion = motion(format!(
            r#"{{"joint_trajectory": {joints}, "multi_dof_joint_trajectory": {{"joint_names": ["{name}"], "points": [{points}]}}}}"#
        ));
        near(&at(&motion, 1.5, &["robot/x"]), &[1.0]);
        let [theta] = at(&motion, 2.0, &["robot/theta"])[..] else { panic!() };
        assert!((theta - (std::f64::consts::TAU - 2.5)).abs() < 1e-9, "{theta}");
        // Joints are splines, the base goes straight.
        near(&at(&motion, 0.25, &["robot/x", "robot/shoulder"]), &[0.25, 3.0 / 16.0 - 2.0 / 64.0]);
        assert_eq!(motion.notes.len(), usize::from(name == "world_joint"), "{:?}", motion.notes);
    }
}

#[test]
fn matrices_of_ompl_take_the_shortest_way() {
    let options = |joints: &str| ReadOptions {
        joints: Some(joints.split(',').map(str::to_owned).collect()),
        ..ReadOptions::default()
    };
    let text = "0.5 3.0 \n1.5 -3.0 \n\n";
    let motion = try_read(text, &options("shoulder,turn")).unwrap();
    let half = std::f64::consts::TAU - 6.0;
    near(&at(&motion, 0.5, &JOINTS), &[1.0, 3.0 + half / 2.0]);
    let as_written = ReadOptions { turns: Turns::AsWritten, ..options("shoulder,turn") };
    near(&at(&try_read(text, &as_written).unwrap(), 0.5, &JOINTS), &[1.0, 0.0]);
    // A free root, on the quaternion geodesic.
    let free = "load/x,load/y,load/z,load/qx,load/qy,load/qz,load/qw";
    let half = 0.5_f64.sqrt();
    let motion = try_read(format!("0 0 0 0 0 0 1\n1 0 0 0 0 {half} {half}\n"), &options(free)).unwrap();
    let eighth = std::f64::consts::FRAC_PI_8;
    near(&at(&motion, 0.5, &["load/x", "load/qz", "load/qw"]), &[0.5, eighth.sin(), eighth.cos()]);
    assert!(refusal(text).contains("--joints"), "{}", refusal(text));
    let error = try_read("0.5 3.0\n1.5\n", &options("shoulder,turn")).unwrap_err();
    assert!(error.starts_with("file:2: state[1]: has 1 numbers, and 2 joints are named"), "{error}");
}

/// An array as numpy writes it.
fn npy(version: u8, descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((header.len() as u16).to_le_bytes()),
        _ => bytes.extend((header.len() as u32).to_le_bytes()),
    }
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

fn bytes(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn with_joints() -> ReadOptions {
    ReadOptions { joints: Some(vec!["shoulder".into(), "turn".into()]), ..ReadOptions::default() }
}

#[test]
fn arrays_of_numpy() {
    let rows: [f64; 6] = [0.0, 1.0, 0.5, 2.0, 1.0, 3.0];
    let columns = [0.0, 0.5, 1.0, 1.0, 2.0, 3.0];
    let single: Vec<u8> = rows.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
    let big: Vec<u8> = rows.iter().flat_map(|x| x.to_be_bytes()).collect();
    let arrays = [
        npy(1, "<f8", false, "(3, 2)", &bytes(&rows)),
        npy(2, "<f8", true, "(3, 2)", &bytes(&columns)),
        npy(3, "<f4", false, "(3, 2)", &single),
        npy(1, ">f8", false, "(3, 2)", &big),
    ];
    for array in arrays {
        let motion = try_read(array, &with_joints()).unwrap();
        near(&at(&motion, 1.5, &JOINTS), &[0.75, 2.5]);
    }
}

#[test]
fn archives_of_numpy() {
    let archive = |entries: &[(&str, Vec<u8>)]| {
        let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    let names: Vec<u8> = ["shoulder", "turn"]
        .iter()
        .flat_map(|n| format!("{n:\0<8}").chars().flat_map(|c| (c as u32).to_le_bytes()).collect::<Vec<_>>())
        .collect();
    let positions = ("positions.npy", npy(1, "<f8", false, "(2, 2)", &bytes(&[0.0, 0.0, 1.0, 2.0])));
    let times = ("times.npy", npy(1, "<f8", false, "(2,)", &bytes(&[0.0, 4.0])));
    let velocities = ("velocities.npy", npy(1, "<f8", false, "(2, 2)", &bytes(&[0.0; 4])));
    let names = ("names.npy", npy(1, "<U8", false, "(2,)", &names));
    let whole = motion(archive(&[positions.clone(), times.clone(), velocities.clone(), names.clone()]));
    assert_eq!((whole.ends(), whole.degree()), (4.0, 3));
    near(&at(&whole, 1.0, &JOINTS), &[3.0 / 16.0 - 2.0 / 64.0, 6.0 / 16.0 - 4.0 / 64.0]);
    let bare = try_read(archive(std::slice::from_ref(&positions)), &with_joints()).unwrap();
    assert!(!bare.timed && bare.degree() == 1);
    assert!(refusal(archive(std::slice::from_ref(&positions))).contains("--joints"));
    let error = refusal(archive(std::slice::from_ref(&times)));
    assert!(error.contains("no array `positions`") && error.contains("times.npy"), "{error}");
    let short = ("times.npy", npy(1, "<f8", false, "(1,)", &bytes(&[0.0])));
    let error = refusal(archive(&[positions, short, names]));
    assert!(error.contains("times: has 1 rows, and positions have 2"), "{error}");
}

#[test]
fn hostile_arrays_are_refused_before_memory_is_asked_for() {
    let refused = |bytes: Vec<u8>, wanted: &str| {
        let error = try_read(bytes, &with_joints()).unwrap_err();
        assert!(error.contains(wanted), "{error}");
    };
    refused(npy(1, "<f8", false, "(1000000000000, 2)", &bytes(&[0.0])), "asks for others");
    refused(npy(1, "<f8", false, "(18446744073709551615, 18446744073709551615)", &bytes(&[0.0])), "asks for others");
    refused(npy(1, "|O", false, "(1, 2)", &bytes(&[0.0, 0.0])), "elements of type");
    refused(npy(1, "<i8", false, "(1, 2)", &bytes(&[0.0, 0.0])), "elements of type");
    refused(npy(9, "<f8", false, "(1, 2)", &bytes(&[0.0, 0.0])), "version 9");
    refused(npy(1, "<f8", false, "(2,)", &bytes(&[0.0, 0.0])), "one row a state");
    refused(npy(1, "<f8", false, "(2, 2)", &bytes(&[0.0, f64::NAN, 0.0, 0.0])), "positions[1] is NaN");
    refused(b"\x93NUMPY\x01\x00\xff\xff".to_vec(), "ends before its header");
    refused(b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec(), "has a header of");
    refused(b"PK\x03\x04rubbish".to_vec(), "archive");
}

#[test]
fn errors_say_where_and_what_to_do() {
    for (text, wanted) in [
        ("time,sholder\n0,1\n1,2\n", "did you mean `robot/shoulder`?"),
        ("time,shoulder\n0,1\n1,x\n", "file:3: row[1], column `shoulder`: `x` is no finite number"),
        ("time,shoulder\n0,1\n1,nan\n", "no finite number"),
        ("time,shoulder\n0,1\n1,1e999\n", "no finite number"),
        ("time,shoulder\n0,1\n1\n", "the row has 1 cells, the header 2"),
        ("time,shoulder\n0,1\n0,2\n", "file:3: row[1]: its time is 0 s, that of the point before is 0 s"),
        ("time,shoulder\n1,1\n0,2\n", "increase strictly"),
        ("time,shoulder,shoulder\n0,1,1\n", "stands there twice"),
        ("time,shoulder,robot/shoulder\n0,1,1\n", "named a second time"),
        ("time,shoulder,turn,turn.velocity\n0,1,1,0\n", "give it for all, or for none"),
        ("time,turn.velocity\n0,1\n", "add a column `turn`"),
        ("time,shoulder\n", "there is no point"),
        ("time,shoulder\n0,1e5\n", "at most 1e4"),
        ("load/qx,load/qy\n0,1\n", "name qx, qy, qz and qw"),
        ("load/qx,load/qy,load/qz,load/qw\n0,1,1,0\n0,1,1,0\n", "has length 1.4142"),
        ("1,2\n3,4\n", "put a line"),
        ("", "is empty"),
        ("{\"joint_names\": [\"shoulder\"]}", "holds no trajectory with points"),
        ("{\"joint_names\": [\"shoulder\"], \"points\": [{\"positions\": [1, 2]}]}", "points[0]: has 2 positions"),
        ("{\"joint_names\": [\"shoulder\"], \"points\": [{\"positions\": [1e400]}]}", "file:1: JSON"),
        (
            "{\"joint_names\": [\"shoulder\"], \"points\": [{\"positions\": [1], \"accelerations\": [1]}]}",
            "no velocities",
        ),
        ("{\"points\": ", "file:1: JSON"),
    ] {
        let error = refusal(text);
        assert!(error.contains(wanted), "{text:?}: {error}");
    }
    let cubic = ReadOptions { interpolation: Interpolation::Cubic, ..ReadOptions::default() };
    let error = try_read("time,shoulder\n0,0\n1,1\n", &cubic).unwrap_err();
    assert!(error.contains("has no velocities") && error.contains("--interpolation"), "{error}");
    let error = try_read("shoulder\n0\n1\n", &cubic).unwrap_err();
    assert!(error.contains("has no times"), "{error}");
    let named = ReadOptions { joints: Some(vec!["turn".into()]), ..ReadOptions::default() };
    assert!(try_read("shoulder\n0\n", &named).unwrap_err().contains("leave --joints out"));
    let forced = ReadOptions { format: Some(Format::Ompl), ..with_joints() };
    assert!(try_read("shoulder,turn\n0,0\n", &forced).unwrap_err().contains("file:1: state[0]"));
    assert!(try_read(vec![0xff, 0xfe, 0, 0], &ReadOptions::default()).is_err());
    let deep = format!("{}{}", "{\"trajectory\":".repeat(100_000), "}".repeat(100_000));
    assert!(refusal(deep).contains("recursion limit"));
}

#[test]
fn followers_may_be_named_where_they_follow() {
    let motion = motion("left_finger,right_finger\n0,0.5\n0.2,0.3\n");
    assert_eq!(motion.coordinates.len(), 1);
    let error = refusal("left_finger,right_finger\n0,0.5\n0.2,0.2\n");
    assert!(error.contains("file:3: row[1]") && error.contains("mimics `robot/left_finger`"), "{error}");
}

#[test]
fn only_regular_files_are_read() {
    let folder = folder();
    let robot = robot().robot;
    let options = ReadOptions::default();
    assert!(read(&folder, &robot, &options).unwrap_err().to_string().contains("not a regular file"));
    #[cfg(unix)]
    assert!(read("/dev/zero".as_ref(), &robot, &options).unwrap_err().to_string().contains("not a regular file"));
    assert!(read(&folder.join("none.csv"), &robot, &options).is_err());
    std::fs::write(folder.join("a.csv"), "shoulder\n0\n1\n").unwrap();
    let motion = read(&folder.join("a.csv"), &robot, &options).unwrap();
    assert!(matches!(motion.segments[0].curves[0], Curve::Number(_)));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn path_files_of_version_2_are_curves() {
    let (sine, cosine) = 0.75_f64.sin_cos();
    let columns = ["robot/shoulder", "load/x", "load/y", "load/z", "load/qx", "load/qy", "load/qz", "load/qw"];
    let knots = [[0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 1.0], [0.5, 0.0, 5.0, 1.0, 0.0, 0.0, sine, cosine]];
    let velocities = [[0.3, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0], [0.0; 8]];
    let file = serde_json::json!({
        "format": "foliate.path/2", "scene": "", "seed": 1, "scheduler": "hand", "simd": "none", "parts": [], "limits": {},
        "coordinates": columns, "documents": { "grippers": {}, "handles": {}, "surfaces": {} }, "ignored_pairs": [],
        "margins": [], "placement_margin": 0.0, "rate_limits": {}, "events": [],
        "segments": [{ "transition": "", "state": "", "attachments": [], "constraints": [], "knots": knots, "times": [0.0, 2.0],
                       "velocities": velocities }],
        "certificate": { "path_tolerance": 1e-4, "max_residual": 0.0, "min_clearance": null, "joint_limits": "within" },
    });
    let motion = motion(file.to_string());
    for time in [0.0, 0.3, 1.0, 1.9, 2.0] {
        let s = time / 2.0;
        let hermite = |column: usize| {
            let (p, q) = (knots[0][column], knots[1][column]);
            let (a, b) = (2.0 * velocities[0][column], 2.0 * velocities[1][column]);
            p + s * a + s * s * (3.0 * (q - p) - 2.0 * a - b) + s * s * s * (a + b - 2.0 * (q - p))
        };
        let mut wanted: Vec<f64> = (0..8).map(hermite).collect();
        let length = wanted[4..].iter().map(|x| x * x).sum::<f64>().sqrt();
        wanted[4..].iter_mut().for_each(|x| *x /= length);
        near(&at(&motion, time, &columns), &wanted);
    }
    // Through zero there is no rotation; a key of the later version is refused in the first.
    let mut through = file.clone();
    through["segments"][0]["velocities"][0][7] = serde_json::json!(-8.0);
    assert!(refusal(through.to_string()).contains("near zero"));
    let mut first = file;
    first["format"] = serde_json::json!("foliate.path/1");
    assert!(refusal(first.to_string()).contains("rate_limits"));
}
