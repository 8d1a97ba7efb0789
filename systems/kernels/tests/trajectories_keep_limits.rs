//! Promise: a path with times keeps its limits everywhere, takes no longer than it must, and goes through the path's knots.

#![allow(clippy::unwrap_used, reason = "what a test expects and does not find fails it")]

use foliate_kernels::trajectory::{
    JerkScratch, Limits, Spline, ThroughScratch, TimedPath, TimingError, TimingScratch, TimingSettings,
    acceleration_jump, blend_polyline, limit_jerk, peak_rates, spline_through, time_at_full_speed, time_optimal,
    time_optimal_below,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Limits of velocity and acceleration.
#[derive(Clone)]
struct Given {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    jerk: Vec<f64>,
}

impl Given {
    fn new(velocity: Vec<f64>, acceleration: Vec<f64>) -> Self {
        let jerk = vec![f64::INFINITY; velocity.len()];
        Self { velocity, acceleration, jerk }
    }

    fn draw(random: &mut ChaCha8Rng, size: usize) -> Self {
        let velocity: Vec<f64> = (0..size).map(|_| random.random_range(0.3..3.0)).collect();
        let acceleration = velocity.iter().map(|v| v / random.random_range(0.05..0.6)).collect();
        Self::new(velocity, acceleration)
    }

    fn limits(&self) -> Limits<'_> {
        Limits { velocity: &self.velocity, acceleration: &self.acceleration, jerk: &self.jerk }
    }
}

fn timed(path: &Spline, given: &Given) -> Result<TimedPath, TimingError> {
    let mut out = TimedPath::default();
    time_optimal(path, given.limits(), TimingSettings::default(), &mut TimingScratch::default(), &mut out)?;
    Ok(out)
}

/// A straight line each of whose coordinates moves by so much.
fn line(by: &[f64]) -> Spline {
    let knots: Vec<f64> = by.iter().map(|_| 0.3).chain(by.iter().map(|b| 0.3 + b)).collect();
    Spline::from_parts(by.len(), vec![0.0, 1.0], knots, [by, by].concat()).unwrap()
}

#[test]
fn a_ceiling_bounds_the_path_velocity() {
    // 2 m at 1 m/s at most; half of that on the whole path, or on its first half.
    let (path, given) = (line(&[2.0]), Given::new(vec![1.0], vec![1.0]));
    let below = |ceiling: &dyn Fn([f64; 2]) -> f64| {
        let mut out = TimedPath::default();
        let (settings, mut scratch) = (TimingSettings::default(), TimingScratch::default());
        time_optimal_below(&path, given.limits(), Some(ceiling), settings, &mut scratch, &mut out).unwrap();
        out.curve
    };
    let free = below(&|_| f64::INFINITY);
    assert!((free.extent() - 3.0).abs() < 1e-2, "{}", free.extent());
    let slow = below(&|_| 0.25);
    assert!((slow.extent() - 4.5).abs() < 1e-2, "{}", slow.extent());
    let half = below(&|[from, _]| if from < 0.5 { 0.25 } else { f64::INFINITY });
    assert!(half.extent() > 3.2 && half.extent() < 4.3, "{}", half.extent());
    let (mut q, mut v, mut fastest) = ([0.0], [0.0], 0.0_f64);
    for part in 0..=1000 {
        let time = half.extent() * f64::from(part) / 1000.0;
        half.position(time, &mut q);
        half.derivative(time, &mut v);
        if q[0] - 0.3 <= 1.0 {
            assert!(v[0] <= 0.5 + 1e-9, "{v:?} at {q:?}");
        }
        fastest = fastest.max(v[0]);
    }
    assert!(fastest > 0.9);
}

fn polyline(random: &mut ChaCha8Rng, given: &Given) -> Spline {
    let (size, count) = (given.velocity.len(), random.random_range(2..12));
    let knots: Vec<f64> = (0..count * size).map(|_| random.random_range(-2.0..2.0)).collect();
    let edge =
        |k: usize| time_at_full_speed(&knots[k * size..][..size], &knots[(k + 1) * size..][..size], &given.velocity);
    // From arcs that are hardly there to arcs that meet.
    let radii: Vec<f64> = (0..count)
        .map(|k| {
            if k == 0 || k + 1 == count {
                0.0
            } else {
                edge(k - 1).min(edge(k)) * 0.5_f64.powi(random.random_range(1..12))
            }
        })
        .collect();
    let mut path = Spline::new(size);
    blend_polyline(&knots, &radii, &given.velocity, &mut path).unwrap();
    path
}

/// Knots on a smooth curve, some of them near one another.
fn dense(random: &mut ChaCha8Rng, given: &Given) -> Spline {
    let size = given.velocity.len();
    let waves: Vec<[f64; 3]> = (0..size)
        .map(|_| [random.random_range(0.2..1.5), random.random_range(0.5..4.0), random.random_range(0.0..6.0)])
        .collect();
    let (mut knots, mut at) = (Vec::new(), 0.0);
    while at < 3.0 {
        knots.extend(waves.iter().map(|[size, frequency, phase]| size * (frequency * at + phase).sin()));
        at += random.random_range(0.01..0.08);
    }
    let mut path = Spline::new(size);
    spline_through(&knots, &given.velocity, &mut ThroughScratch::default(), &mut path).unwrap();
    path
}

fn waypoints(random: &mut ChaCha8Rng, given: &Given) -> Spline {
    let (size, count) = (given.velocity.len(), random.random_range(2..20));
    let knots: Vec<f64> = (0..count * size).map(|_| random.random_range(-2.0..2.0)).collect();
    let mut path = Spline::new(size);
    spline_through(&knots, &given.velocity, &mut ThroughScratch::default(), &mut path).unwrap();
    path
}

/// Largest shares of limits, velocity and acceleration, at 1 kHz. The polynomials are written here once more, in powers of time.
fn sampled(curve: &Spline, given: &Given, from: f64) -> f64 {
    let mut worst = 0.0_f64;
    let mut piece = 0;
    let times: Vec<f64> = curve.parameters().iter().map(|t| from + t).collect();
    for tick in 0.. {
        let now = from + f64::from(tick) * 1e-3;
        if now > times[times.len() - 1] {
            return worst;
        }
        while piece + 1 < curve.pieces() && now > times[piece + 1] {
            piece += 1;
        }
        let (h, t) = (times[piece + 1] - times[piece], now - times[piece]);
        for i in 0..curve.size() {
            let (q0, q1) = (curve.knot(piece)[i], curve.knot(piece + 1)[i]);
            let (v0, v1) = (curve.velocity(piece)[i], curve.velocity(piece + 1)[i]);
            let c2 = 3.0 * (q1 - q0) / (h * h) - (2.0 * v0 + v1) / h;
            let c3 = -2.0 * (q1 - q0) / (h * h * h) + (v0 + v1) / (h * h);
            let velocity = (v0 + t * (2.0 * c2 + t * 3.0 * c3)) / given.velocity[i];
            let acceleration = (2.0 * c2 + 6.0 * t * c3) / given.acceleration[i];
            worst = worst.max(velocity.abs()).max(acceleration.abs());
        }
    }
    worst
}

/// Every knot of the path is a knot of the curve, or lies on one of its straight pieces.
fn goes_through(path: &Spline, timed: &TimedPath) {
    for k in 0..path.len() {
        let at = path.parameters()[k];
        let next = timed.parameters.partition_point(|p| *p < at);
        let found = if timed.parameters[next] == at {
            timed.curve.knot(next).to_vec()
        } else {
            // The knot lies within a straight run, where positions go linearly with the path parameter.
            let (from, to) = (timed.parameters[next - 1], timed.parameters[next]);
            let share = (at - from) / (to - from);
            (0..path.size())
                .map(|i| {
                    timed.curve.knot(next - 1)[i] + share * (timed.curve.knot(next)[i] - timed.curve.knot(next - 1)[i])
                })
                .collect()
        };
        for (i, found) in found.iter().enumerate() {
            assert!((found - path.knot(k)[i]).abs() < 1e-9, "knot {k}: {found} {}", path.knot(k)[i]);
        }
    }
}

#[test]
fn limits_hold_everywhere() {
    let mut random = ChaCha8Rng::seed_from_u64(14);
    for round in 0..240 {
        let size = random.random_range(2..16);
        let given = Given::draw(&mut random, size);
        let path = match round % 3 {
            0 => polyline(&mut random, &given),
            1 => dense(&mut random, &given),
            _ => waypoints(&mut random, &given),
        };
        let timed = timed(&path, &given).unwrap();
        let curve = &timed.curve;
        curve.check().unwrap();
        let peaks = peak_rates(curve, given.limits());
        assert!(peaks.keep_limits(1e-12), "round {round}: {peaks:?}");
        // Slower than necessary it is not: some limit is reached.
        assert!(peaks.velocity.share.max(peaks.acceleration.share) > 0.999, "round {round}: {peaks:?}");
        for from in [0.0, 87.123_456_789] {
            let worst = sampled(curve, &given, from);
            assert!(worst <= 1.0 + 1e-9, "round {round} at 1 kHz from {from}: {worst}");
        }
        let last = curve.len() - 1;
        assert!(curve.velocity(0).iter().chain(curve.velocity(last)).all(|v| *v == 0.0));
        assert_eq!((curve.knot(0), curve.knot(last)), (path.knot(0), path.knot(path.len() - 1)));
        goes_through(&path, &timed);
    }
}

#[test]
fn one_line_is_a_trapezoid() {
    let mut random = ChaCha8Rng::seed_from_u64(15);
    let mut shapes = [0; 2];
    for _ in 0..500 {
        let size = random.random_range(1..8);
        let given = Given::draw(&mut random, size);
        let reach = 10.0_f64.powf(random.random_range(-3.0..0.7));
        let by: Vec<f64> = (0..size).map(|_| random.random_range(-reach..reach)).collect();
        // Along the line the parameter goes from 0 to 1: its own limits are the smallest of the coordinates'.
        let least = |of: &[f64]| of.iter().zip(&by).map(|(limit, by)| limit / by.abs()).fold(f64::INFINITY, f64::min);
        let (v, a) = (least(&given.velocity), least(&given.acceleration));
        let known = if v * v >= a { 2.0 / a.sqrt() } else { 1.0 / v + v / a };
        let curve = timed(&line(&by), &given).unwrap().curve;
        // A phase of full speed that is shorter than 2 ms or 1 % is drawn out: rates of shorter pieces are uncertain.
        let full_speed = if v * v >= a { 0.0 } else { 1.0 / v - v / a };
        let drawn_out = full_speed > 0.0 && full_speed < f64::min(2e-3, 0.01 / v);
        let most = if drawn_out { 1e-4 } else { 1e-9 };
        assert!((curve.extent() / known - 1.0).abs() < most, "{} {known}", curve.extent());
        assert!(curve.len() <= 4);
        shapes[usize::from(v * v >= a)] += 1;
    }
    assert!(shapes.iter().all(|count| *count > 50), "{shapes:?}");
}

#[test]
fn a_straight_line_stays_one_when_it_is_cut() {
    let given = Given::new(vec![1.0, 2.0], vec![3.0, 3.0]);
    let whole = timed(&line(&[2.0, -1.0]), &given).unwrap().curve;
    let mut path = line(&[2.0, -1.0]);
    for k in 1..50 {
        path.cut(f64::from(k) / 50.0);
    }
    let cut = timed(&path, &given).unwrap().curve;
    assert_eq!(cut.len(), whole.len());
    assert!((cut.extent() - whole.extent()).abs() < 1e-12);
}

#[test]
fn larger_limits_take_no_longer() {
    let mut random = ChaCha8Rng::seed_from_u64(16);
    for round in 0..60 {
        let size = random.random_range(2..10);
        let given = Given::draw(&mut random, size);
        let path = if round % 2 == 0 { polyline(&mut random, &given) } else { waypoints(&mut random, &given) };
        let duration = |given: &Given| timed(&path, given).unwrap().curve.extent();
        let first = duration(&given);
        // Twice as fast: velocity limits times 2, acceleration limits times 4.
        let mut faster = given.clone();
        faster.velocity.iter_mut().for_each(|v| *v *= 2.0);
        faster.acceleration.iter_mut().for_each(|a| *a *= 4.0);
        // Phases that would be shorter than 2 ms are other ones.
        assert!((duration(&faster) - 0.5 * first).abs() < 1e-4 * first, "{} {first}", duration(&faster));
        // Another grid may lose what its intervals lose.
        let mut larger = given.clone();
        let one = random.random_range(0..size);
        larger.velocity[one] *= 1.5;
        assert!(duration(&larger) <= first * 1.003, "{} {first}", duration(&larger));
        larger.acceleration[one] *= 2.0;
        assert!(duration(&larger) <= first * 1.003, "{} {first}", duration(&larger));
    }
}

#[test]
fn a_circle_takes_what_it_must() {
    // Once round a unit circle: at each point a² = q''² + ..., and no faster than √(a / r) in the steady part; two coordinates, so
    // that both limits are reached. The curve is compared with a grid ten times as fine.
    let given = Given::new(vec![10.0, 10.0], vec![1.0, 1.0]);
    let knots: Vec<f64> = (0..=200)
        .flat_map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 200.0;
            [angle.cos(), angle.sin()]
        })
        .collect();
    let mut path = Spline::new(2);
    spline_through(&knots, &given.velocity, &mut ThroughScratch::default(), &mut path).unwrap();
    let usual = timed(&path, &given).unwrap().curve.extent();
    let mut out = TimedPath::default();
    let fine = TimingSettings { turn: 0.005, ..TimingSettings::default() };
    let best = time_optimal(&path, given.limits(), fine, &mut TimingScratch::default(), &mut out).unwrap().duration;
    assert!(usual < 1.005 * best && usual > 0.999 * best, "{usual} {best}");
}

#[test]
fn coordinates_without_limits_do_not_count() {
    let (bound, free) = (Given::new(vec![1.0], vec![2.0]), f64::INFINITY);
    let alone = timed(&line(&[1.5]), &bound).unwrap().curve;
    let both = timed(&line(&[1.5, 40.0]), &Given::new(vec![1.0, free], vec![2.0, free])).unwrap().curve;
    assert_eq!(alone.parameters(), both.parameters());
    assert_eq!(both.knot(both.len() - 1), [1.8, 40.3]);
    // A coordinate that stands still may have the limit 0.
    timed(&line(&[1.5, 0.0]), &Given::new(vec![1.0, 0.0], vec![2.0, 0.0])).unwrap();
}

#[test]
fn what_has_no_time_is_refused() {
    let path = line(&[1.0, 2.0]);
    let refused = |velocity: [f64; 2], acceleration: [f64; 2]| {
        timed(&path, &Given::new(velocity.to_vec(), acceleration.to_vec())).unwrap_err()
    };
    let free = f64::INFINITY;
    assert_eq!(refused([free; 2], [free; 2]), TimingError::Unlimited { piece: 0 });
    assert_eq!(refused([1.0; 2], [free; 2]), TimingError::Unlimited { piece: 0 });
    assert_eq!(refused([1.0, f64::NAN], [1.0; 2]), TimingError::Limit { coordinate: 1 });
    assert_eq!(refused([1.0; 2], [-1.0, 1.0]), TimingError::Limit { coordinate: 0 });
    assert_eq!(refused([1.0, 0.0], [1.0; 2]), TimingError::Immovable { coordinate: 1 });
    assert_eq!(refused([1e-320; 2], [1e308; 2]), TimingError::Precision);
    assert_eq!(timed(&path, &Given::new(vec![1.0], vec![1.0])).unwrap_err(), TimingError::LimitCount);
    assert_eq!(timed(&Spline::new(2), &Given::new(vec![1.0; 2], vec![1.0; 2])).unwrap_err(), TimingError::Empty);
    let mut broken = path.clone();
    broken.knot_mut(1)[0] = f64::NAN;
    assert!(matches!(timed(&broken, &Given::new(vec![1.0; 2], vec![1.0; 2])), Err(TimingError::Path(_))));
}

#[test]
fn a_path_that_stands_still_takes_no_time() {
    let given = Given::new(vec![1.0; 2], vec![1.0; 2]);
    let still = timed(&line(&[0.0, 0.0]), &given).unwrap();
    assert_eq!((still.curve.len(), still.curve.extent()), (1, 0.0));
    let mut one = Spline::new(2);
    one.push(3.0, &[1.0, 2.0], &[0.5, 0.0]);
    let timed = timed(&one, &given).unwrap();
    assert_eq!((timed.curve.knot(0), timed.curve.velocity(0)), ([1.0, 2.0].as_slice(), [0.0, 0.0].as_slice()));
}

#[test]
fn tiny_and_huge_paths_are_timed() {
    for size in [1e-7, 1e-4, 1e3, 1e6] {
        let given = Given::new(vec![1.0, 1.0], vec![2.0, 2.0]);
        let knots = [0.0, 0.0, size, 0.1 * size, size, size, 0.0, 2.0 * size];
        let mut path = Spline::new(2);
        blend_polyline(&knots, &[0.0, 0.2 * size, 0.01 * size, 0.0], &given.velocity, &mut path).unwrap();
        let curve = timed(&path, &given).unwrap().curve;
        assert!(peak_rates(&curve, given.limits()).keep_limits(1e-9), "{size}");
        let least = path.extent().max(2.0 * (path.extent() / 2.0).sqrt());
        assert!(curve.extent() > 0.7 * least && curve.extent() < 3.0 * least, "{size}: {} {least}", curve.extent());
    }
}

#[test]
fn what_the_scratch_holds_changes_nothing() {
    let mut random = ChaCha8Rng::seed_from_u64(17);
    let (mut scratch, mut out) = (TimingScratch::default(), TimedPath::default());
    for _ in 0..20 {
        let size = random.random_range(2..10);
        let given = Given::draw(&mut random, size);
        let path = waypoints(&mut random, &given);
        time_optimal(&path, given.limits(), TimingSettings::default(), &mut scratch, &mut out).unwrap();
        assert_eq!(out, timed(&path, &given).unwrap());
    }
}

#[test]
fn limited_jerk_keeps_all_limits() {
    let mut random = ChaCha8Rng::seed_from_u64(18);
    let (mut scratch, mut out) = (JerkScratch::default(), Spline::new(0));
    for round in 0..120 {
        let size = random.random_range(2..12);
        let mut given = Given::draw(&mut random, size);
        let path = match round % 3 {
            0 => polyline(&mut random, &given),
            1 => dense(&mut random, &given),
            _ => waypoints(&mut random, &given),
        };
        let curve = timed(&path, &given).unwrap().curve;
        let ramp = 10.0_f64.powf(random.random_range(-2.0..-0.3));
        given.jerk = given.acceleration.iter().map(|a| a / ramp * random.random_range(1.0..3.0)).collect();
        given.jerk[0] = f64::INFINITY;
        let report = limit_jerk(&curve, given.limits(), &mut scratch, &mut out).unwrap();
        let peaks = peak_rates(&out, given.limits());
        assert!(peaks.keep_limits(1e-12) && peaks.jerk.share <= 1.0 + 1e-9, "round {round}: {peaks:?}");
        // Twice the ramp is sure to be enough; whole samples make it at most twice as much.
        assert!(report.window <= 4.0 * ramp, "round {round}: {report:?} {ramp}");
        let longer = report.duration - curve.extent();
        assert!((longer - 1.25 * report.window).abs() <= 1e-4 * report.duration, "round {round}: {report:?} {longer}");
        assert!(acceleration_jump(&out, &given.acceleration).share < 1e-6, "round {round}");
        let (last, end) = (curve.len() - 1, out.len() - 1);
        assert_eq!((out.knot(0), out.knot(end)), (curve.knot(0), curve.knot(last)));
        assert!(out.velocity(0).iter().chain(out.velocity(end)).all(|v| *v == 0.0));
        for from in [0.0, 87.123_456_789] {
            assert!(sampled(&out, &given, from) <= 1.0 + 1e-9, "round {round} from {from}");
        }
        // It passes where the given curve passes, but for what the average cuts off.
        let (mut here, mut there) = (vec![0.0; size], vec![0.0; size]);
        for k in 0..=200 {
            let at = report.duration * f64::from(k) / 200.0;
            out.position(at, &mut here);
            curve.position(at - report.delay, &mut there);
            for i in 0..size {
                // Next to the ends the average reaches beyond the curve, where it stands still.
                let most = 0.06 * given.acceleration[i] * report.window * report.window + 1e-9;
                assert!(
                    (here[i] - there[i]).abs() <= 2.0 * most,
                    "round {round} coordinate {i}: {} {most}",
                    here[i] - there[i]
                );
            }
        }
    }
}
