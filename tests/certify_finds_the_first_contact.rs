//! The first contact of a motion is found where it is, of curves as of polylines; what is called free is free everywhere.
#![allow(non_snake_case, reason = "pose names carry their frames")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that cannot go on says so")]

mod certify_common;

use certify_common::{arm, ball, certify, cuboid, joint, link, motion, point, scene, slider};
use foliate::certify::{Attachment, Certifier, CertifyOptions, CertifyReport, Interpolation, Motion, Point, Verdict};
use foliate::components::Pose;
use foliate::components::problem::Problem;
use foliate::kernels::collision::{CollisionScene, PairRule};
use foliate::kernels::collision::{CollisionScratch, DistanceQuery, PairId, pair_clearance};
use foliate::kernels::kinematics::Kinematics;
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const EXACT: f64 = 1e-6;

/// Where a growing function is zero in [low, high].
fn zero(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = low.midpoint(high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    low
}

fn assert_contact(problem: &Problem, motion: &Motion, wanted: f64) {
    let report = certify(problem, motion, &CertifyOptions::default());
    assert_eq!(report.verdict, Verdict::Contact, "{report:?}");
    let contact = report.contact.unwrap();
    assert!((contact.at - wanted).abs() < EXACT, "{} {wanted}", contact.at);
    assert!(report.free_until <= wanted && wanted - report.free_until < EXACT, "{} {wanted}", report.free_until);
}

#[test]
fn a_slider_meets_a_wall_when_it_does() {
    let problem = slider();
    let points = |velocity: Option<f64>, acceleration: Option<f64>| {
        let with = |time, x| Point {
            velocities: velocity.map(|v| vec![v]),
            accelerations: acceleration.map(|a| vec![a]),
            ..point(time, &[x])
        };
        [with(0.0, 0.0), with(2.0, 2.0)]
    };
    let straight = motion(&problem, &["robot/slide"], &points(None, None), Interpolation::Auto);
    assert_contact(&problem, &straight, 0.9);
    // x(t) = 2 (3 s² − 2 s³), s = t/2; and 2 (10 s³ − 15 s⁴ + 6 s⁵).
    let cubic = motion(&problem, &["robot/slide"], &points(Some(0.0), None), Interpolation::Auto);
    assert_contact(&problem, &cubic, 2.0 * zero(|s| 2.0 * (3.0 - 2.0 * s) * s * s - 0.9, 0.0, 1.0));
    let quintic = motion(&problem, &["robot/slide"], &points(Some(0.0), Some(0.0)), Interpolation::Auto);
    let x = |s: f64| 2.0 * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
    assert_contact(&problem, &quintic, 2.0 * zero(|s| x(s) - 0.9, 0.0, 1.0));
    // Without times places count points, and without velocities they are straight.
    let untimed = points(Some(0.0), None).map(|p| Point { time: None, ..p });
    let untimed = motion(&problem, &["robot/slide"], &untimed, Interpolation::Auto);
    assert_contact(&problem, &untimed, 0.45);
}

#[test]
fn an_arm_meets_a_ball_when_it_does_and_margins_count() {
    let swing = |problem: &Problem| {
        motion(problem, &["robot/turn"], &[point(1.0, &[0.0]), point(3.0, &[2.0])], Interpolation::Auto)
    };
    let problem = arm("");
    assert_contact(&problem, &swing(&problem), 2.0 - 2.0 * 0.05_f64.asin());
    let margin = "margins = [{ pair = [\"robot/arm\", \"post/post\"], distance = 0.02 }]\n";
    let problem = arm(margin);
    assert_contact(&problem, &swing(&problem), 2.0 - 2.0 * 0.06_f64.asin());
    let report = certify(&problem, &swing(&problem), &CertifyOptions::default());
    assert_eq!(report.contact.unwrap().margin, 0.02);
}

#[test]
fn the_depth_of_a_contact_is_that_of_the_deepest_place() {
    let problem = slider();
    let there = motion(
        &problem,
        &["slide"],
        &[point(0.0, &[0.0]), point(1.0, &[0.93]), point(2.0, &[0.0])],
        Interpolation::Auto,
    );
    let contact = certify(&problem, &there, &CertifyOptions::default()).contact.unwrap();
    let depth = contact.depth.unwrap();
    assert!((depth - 0.03).abs() < 1e-3 && depth <= 0.03 + 1e-9, "{depth}");
    assert!((contact.deepest_at - 1.0).abs() < 0.02, "{}", contact.deepest_at);
    // It parts where it came in, on the way back.
    assert!((contact.until - (2.0 - 0.9 / 0.93)).abs() < 0.05, "{}", contact.until);
    assert_eq!(contact.pair.links, ["robot/ball", "wall/wall"]);
}

/// From 0 to 1 and a curve between them, which at its farthest is a quarter beyond 1; a post stands there.
#[test]
fn a_spline_that_bulges_past_its_points_is_caught() {
    let post = |x: f64| {
        let robot = link("base", "", [0.0; 3])
            + &link("ball", &ball(0.01), [0.0; 3])
            + &joint("slide", "prismatic", "1 0 0", "base", "ball", 0.0);
        let post = link("post", &cuboid(0.001, 0.1, 0.1), [x, 0.0, 0.0]);
        let start = "[start]\n\"robot/slide\" = 0.0\n[[goal]]\nconfiguration = { \"robot/slide\" = 0.5 }\n";
        scene(&[("robot", "robot", "", robot), ("post", "environment", "", post)], start)
    };
    let with = |time, x, v: f64| Point { velocities: Some(vec![v]), ..point(time, &[x]) };
    // x(t) = t − 4/3 … : a Hermite curve with slopes 4 and −4 reaches 1.5 at its middle.
    let points = [with(0.0, 0.0, 4.0), with(1.0, 0.0, -4.0)];
    let near = post(0.98);
    let bulge = motion(&near, &["slide"], &points, Interpolation::Auto);
    let report = certify(&near, &bulge, &CertifyOptions::default());
    // x = 4 t (1 − t), at most 1; the post is met at x = 0.98 − 0.0005 − 0.01.
    let wanted = zero(|t| 4.0 * t * (1.0 - t) - 0.9695, 0.0, 0.5);
    assert!((report.contact.unwrap().at - wanted).abs() < EXACT);
    // The chord of the points does not move at all, and a straight motion is free.
    let straight = motion(&near, &["slide"], &points, Interpolation::Linear);
    assert_eq!(certify(&near, &straight, &CertifyOptions::default()).verdict, Verdict::Free);
    // A tenth of a millimetre of air is enough.
    let far = post(1.0 + 0.01 + 0.0005 + 1e-4);
    let report = certify(&far, &bulge, &CertifyOptions { clearance: true, ..CertifyOptions::default() });
    assert_eq!(report.verdict, Verdict::Free, "{report:?}");
    let clearance = report.clearance.unwrap();
    assert!((clearance.measured.unwrap() - 1e-4).abs() < 1e-6 && clearance.at_least <= 1e-4, "{clearance:?}");
    assert!((clearance.at.unwrap() - 0.5).abs() < 1e-2);
}

/// A gantry along x and z above a box on a table; a low bridge stands in the way.
fn crane() -> Problem {
    let robot = link("base", "", [0.0; 3])
        + &link("cart", "", [0.0; 3])
        + &link("hand", &cuboid(0.1, 0.1, 0.1), [0.0, 0.0, 0.0])
        + &joint("x", "prismatic", "1 0 0", "base", "cart", 0.0)
        + &joint("z", "prismatic", "0 0 1", "cart", "hand", 0.0);
    let load = link("box", &cuboid(0.2, 0.2, 0.2), [0.0; 3]);
    let post = link("post", &cuboid(0.1, 1.0, 0.1), [2.0, 0.0, 0.62]);
    scene(
        &[
            ("robot", "robot", "", robot),
            ("load", "object", "root = \"freeflyer\"", load),
            ("post", "environment", "", post),
        ],
        "[start]\n\"robot/x\" = 0.0\n\"robot/z\" = 1.0\nload = { xyz = [0.0, 0.0, 0.8] }\n[[goal]]\n\
         configuration = { \"robot/x\" = 1.0 }\n",
    )
}

#[test]
fn what_is_carried_collides_too() {
    let problem = crane();
    let points = [point(0.0, &[0.0, 1.0]), point(3.0, &[3.0, 1.0])];
    let drive = motion(&problem, &["x", "z"], &points, Interpolation::Auto);
    // The hand alone is above the post: its lower side at 0.95, the post's top at 0.67.
    assert_eq!(certify(&problem, &drive, &CertifyOptions::default()).verdict, Verdict::Free);
    let attach =
        |time: f64, link: Option<&str>| Attachment { object: "load".into(), link: link.map(str::to_owned), time };
    // The load hangs below it, its lower side at 0.7: free as well.
    let options = |attachments: Vec<Attachment>| CertifyOptions { attachments, ..CertifyOptions::default() };
    let carried = certify(&problem, &drive, &options(vec![attach(f64::NEG_INFINITY, Some("hand"))]));
    assert_eq!(carried.verdict, Verdict::Free, "{carried:?}");
    let lower = [point(0.0, &[0.0, 1.0]), point(1.0, &[0.0, 0.95]), point(4.0, &[3.0, 0.95])];
    let lower = motion(&problem, &["x", "z"], &lower, Interpolation::Auto);
    let carried = certify(&problem, &lower, &options(vec![attach(0.0, Some("robot/hand"))]));
    let contact = carried.contact.unwrap();
    // The load's front at x + 0.1 meets the post's at 1.95, one metre a second from t = 1 on.
    assert!((contact.at - 2.85).abs() < EXACT, "{contact:?}");
    assert_eq!(contact.pair.links, ["load/box", "post/post"]);
    assert!(carried.free_until > 2.849, "{}", carried.free_until);
    // Let go before that it stays behind, and the hand alone passes.
    let let_go = vec![attach(0.0, Some("hand")), attach(2.0, None)];
    let report = certify(&problem, &lower, &options(let_go));
    assert_eq!((report.verdict, report.free_until), (Verdict::Free, 4.0), "{report:?}");
    // Taken on the way, let go and taken again at once it meets the post as well, and what was proved before is kept: its front
    // is at x + 0.09 then.
    let late = [point(0.0, &[0.0, 0.96]), point(1.0, &[1.0, 0.9]), point(3.0, &[3.0, 0.9])];
    let late = motion(&problem, &["x", "z"], &late, Interpolation::Auto);
    let take = vec![attach(0.01, Some("hand")), attach(0.5, None), attach(0.5, Some("hand"))];
    let report = certify(&problem, &late, &options(take));
    assert!((report.contact.as_ref().unwrap().at - 1.86).abs() < EXACT, "{report:?}");
    assert!((report.free_until - 1.86).abs() < EXACT, "{report:?}");
    // Taken only later it is left where it stands, in the way of the hand that comes down.
    let down = [point(0.0, &[0.0, 1.0]), point(1.0, &[0.0, 0.9])];
    let down = motion(&problem, &["x", "z"], &down, Interpolation::Auto);
    let report = certify(&problem, &down, &options(vec![attach(0.9, Some("hand"))]));
    // Bounds of carried objects are not checked, and a note says so; of other objects there is no note.
    let says =
        |report: &CertifyReport| report.notes.iter().any(|n| n.contains("roots of objects") && n.ends_with(": load"));
    assert!(says(&report), "{:?}", report.notes);
    assert!(!says(&certify(&problem, &down, &CertifyOptions::default())));
    let contact = report.contact.unwrap();
    assert!((contact.at - 0.5).abs() < EXACT, "{contact:?}");
}

#[test]
fn what_may_touch_is_left_out_and_counted() {
    let problem = slider();
    let into = motion(&problem, &["slide"], &[point(0.0, &[0.0]), point(1.0, &[1.0])], Interpolation::Auto);
    let certifier = Certifier::new(&problem, &[("robot/ball".into(), "wall".into())]).unwrap();
    let report = certifier.certify(&into, &CertifyOptions::default(), &mut CollisionScratch::new()).unwrap();
    assert_eq!((report.verdict, report.pairs.tested, report.pairs.touch_allowed), (Verdict::Free, 0, 1));
    assert!(report.notes.iter().any(|n| n.contains("no pair of shapes was tested")), "{:?}", report.notes);
    assert!(report.clearance.is_none());
}

#[test]
fn limits_of_work_leave_it_undecided() {
    let problem = slider();
    let into = motion(&problem, &["slide"], &[point(0.0, &[0.0]), point(1.0, &[1.0])], Interpolation::Auto);
    let certifier = Certifier::new(&problem, &[]).unwrap();
    let mut scratch = CollisionScratch::new();
    let options = CertifyOptions { work_limit: 2, ..CertifyOptions::default() };
    let report = certifier.certify(&into, &options, &mut scratch).unwrap();
    assert_eq!(report.verdict, Verdict::Undecided, "{report:?}");
    assert!(report.free_until < 0.9 && report.undecided.is_some());
    let report = certifier.certify_while(&into, &CertifyOptions::default(), &mut scratch, &|| false).unwrap();
    assert_ne!(report.verdict, Verdict::Free, "{report:?}");
}

/// Two boxes slide along each other without a gap: whether they touch cannot be decided.
#[test]
fn what_grazes_is_undecided_or_in_contact_and_never_free() {
    let robot = link("base", "", [0.0; 3])
        + &link("ball", &cuboid(0.2, 0.2, 0.2), [0.0; 3])
        + &joint("slide", "prismatic", "1 0 0", "base", "ball", 0.0);
    let start = "[start]\n\"robot/slide\" = 0.0\n[[goal]]\nconfiguration = { \"robot/slide\" = 0.5 }\n";
    for gap in [0.0, 5e-9, -1e-9] {
        let wall = link("wall", &cuboid(1.0, 1.0, 1.0), [1.0, 0.0, 0.6 + gap]);
        let problem = scene(&[("robot", "robot", "", robot.clone()), ("wall", "environment", "", wall)], start);
        let along = motion(&problem, &["slide"], &[point(0.0, &[0.0]), point(1.0, &[1.0])], Interpolation::Auto);
        let report = certify(&problem, &along, &CertifyOptions::default());
        assert_ne!(report.verdict, Verdict::Free, "{gap}: {report:?}");
        assert!((report.free_until - 0.4).abs() < 1e-2, "{gap}: {}", report.free_until);
    }
}

/// An arm of three joints among posts, chosen at random.
fn among_posts(random: &mut ChaCha8Rng) -> Problem {
    let mut unit = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let mut robot = link("base", "", [0.0; 3]);
    let (mut parent, mut x) = (String::from("base"), 0.0);
    for (index, axis) in ["0 0 1", "0 1 0", "0 0 1"].iter().enumerate() {
        let name = format!("link{index}");
        robot += &link(&name, &cuboid(0.3, 0.04, 0.04), [0.2, 0.0, 0.0]);
        robot += &joint(&format!("j{index}"), "revolute", axis, &parent, &name, x);
        (parent, x) = (name, 0.4);
    }
    let mut posts = link("root", "", [0.0; 3]);
    for index in 0..4 {
        let name = format!("post{index}");
        let (angle, far) = (std::f64::consts::TAU * unit(), 0.45 + 0.7 * unit());
        let at = [far * angle.cos(), far * angle.sin(), unit() - 0.5];
        posts += &link(&name, &cuboid(0.003, 0.003, 0.6), at);
        posts += &format!(r#"<joint name="f{index}" type="fixed"><parent link="root"/><child link="{name}"/></joint>"#);
    }
    scene(
        &[("robot", "robot", "", robot), ("posts", "environment", "", posts)],
        "[start]\n\"robot/j0\" = 0.0\n[[goal]]\nconfiguration = { \"robot/j0\" = 0.5 }\n",
    )
}

/// The least distance beyond margins at a time, by measuring every pair.
struct Sampler {
    scene: CollisionScene,
    kinematics: Kinematics,
    start: Vec<f64>,
    X_WJ: Vec<Pose>,
}

impl Sampler {
    fn new(problem: &Problem) -> Self {
        let rule = PairRule { ignored: &problem.ignored_pairs, ..PairRule::default() };
        let scene = CollisionScene::new(&problem.robot, &rule);
        let kinematics = Kinematics::new(&problem.robot);
        let X_WJ = vec![Pose::identity(); kinematics.bodies()];
        Self { scene, kinematics, start: problem.start.clone(), X_WJ }
    }

    fn distance(&mut self, motion: &Motion, place: f64) -> f64 {
        motion.write(place, &mut self.start);
        self.kinematics.forward(&self.start, &mut self.X_WJ);
        let mut least = f64::INFINITY;
        for pair in 0..self.scene.pairs().len() as u32 {
            let ask = DistanceQuery::exact(least.max(0.0));
            least = least.min(pair_clearance(&self.scene, PairId(pair), &self.X_WJ, ask, &mut DVec3::ZERO.clone()));
        }
        least
    }
}

#[test]
fn samples_never_disagree() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut free, mut contacts) = (0, 0);
    for round in 0..60 {
        let problem = among_posts(&mut random);
        let mut unit = || 2.0 * f64::from(random.next_u32()) / f64::from(u32::MAX) - 1.0;
        let degree = round % 3;
        let points: Vec<Point> = (0..4)
            .map(|i| Point {
                velocities: (degree > 0).then(|| (0..3).map(|_| 1.5 * unit()).collect()),
                accelerations: (degree > 1).then(|| (0..3).map(|_| 2.0 * unit()).collect()),
                ..point(f64::from(i), &[1.2 * unit(), 1.2 * unit(), 1.2 * unit()])
            })
            .collect();
        let motion = motion(&problem, &["j0", "j1", "j2"], &points, Interpolation::Auto);
        let report = certify(&problem, &motion, &CertifyOptions { clearance: true, ..CertifyOptions::default() });
        let mut sampler = Sampler::new(&problem);
        let count = 3000;
        let mut least = f64::INFINITY;
        for i in 0..=count {
            let place = 3.0 * f64::from(i) / f64::from(count);
            let time = motion.time(place);
            let distance = sampler.distance(&motion, place);
            if time < report.free_until || report.verdict == Verdict::Free {
                assert!(distance > 0.0, "round {round}: {distance} at {time}, free until {}", report.free_until);
                least = least.min(distance);
            }
        }
        match report.verdict {
            Verdict::Free => {
                free += 1;
                let clearance = report.clearance.unwrap();
                assert!(clearance.at_least <= least, "round {round}: {clearance:?} {least}");
                // A measured value, and no more than a tenth or a tenth of a millimetre above what is proved.
                let measured = clearance.measured.unwrap();
                let at = motion.place(clearance.at.unwrap());
                let there = sampler.distance(&motion, at);
                assert!(
                    there <= measured + 2e-6 && there >= clearance.at_least,
                    "round {round}: {there} {clearance:?}"
                );
                let allowed = (0.1 * measured).max(1e-4) + 1e-9;
                assert!(clearance.at_least >= measured - allowed, "round {round}: {clearance:?} {least}");
                assert!(clearance.at_least >= least - (0.1 * least).max(1e-4), "round {round}: {clearance:?} {least}");
            }
            Verdict::Contact => {
                contacts += 1;
                let at = report.contact.unwrap().at;
                assert!(sampler.distance(&motion, motion.place(at)) <= 1e-8, "round {round}");
                assert!(at - report.free_until < 1e-4, "round {round}: {} {at}", report.free_until);
            }
            Verdict::Undecided => {}
        }
    }
    assert!(free > 5 && contacts > 5 && free + contacts > 55, "{free} {contacts}");
}
