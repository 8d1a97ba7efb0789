//! Many points, eight to a row: which of them lies farthest, by one source for every processor and the same bit for bit as one
//! after another.

use crate::collision::solids::volumes::Capsule;
use crate::lanes::{F64Row, Isa, Kernel, Lanes, Level, Row, Vector3};
use glam::DVec3;

/// Coordinates up to here have squares and products whose sums are finite.
const LARGEST: f64 = 1e150;

/// Points in lanes; the last row is filled up with the last point.
#[derive(Clone, Debug)]
pub(crate) struct PointRows {
    rows: Vec<[F64Row; 3]>,
    count: usize,
    /// How it is computed, not what.
    lanes: Level,
}

impl PointRows {
    /// None where there are no points, or coordinates too large to compute with.
    pub(crate) fn of(points: &[DVec3]) -> Option<Self> {
        let last = points.last()?;
        if !points.iter().all(|p| p.abs().cmplt(DVec3::splat(LARGEST)).all()) {
            return None;
        }
        let row = |points: &[DVec3]| {
            let coordinate = |axis: usize| Row(std::array::from_fn(|lane| points.get(lane).unwrap_or(last)[axis]));
            [coordinate(0), coordinate(1), coordinate(2)]
        };
        Some(Self { rows: points.chunks(8).map(row).collect(), count: points.len(), lanes: Level::detected() })
    }

    /// Number of the point that lies farthest in a direction, of several the last; none where the largest product is a zero, of
    /// which there are two.
    pub(crate) fn last_along(&self, d: DVec3) -> Option<usize> {
        let (most, found) = self.lanes.run(LastAlong { rows: &self.rows, d });
        (most != 0.0).then(|| found.min(self.count - 1))
    }

    /// Number of the point that lies farthest from another, of several the last, and the square of its distance, m².
    pub(crate) fn last_from(&self, from: DVec3) -> (usize, f64) {
        let (most, found) = self.lanes.run(LastFrom { rows: &self.rows, from });
        (found.min(self.count - 1), most)
    }

    /// How far the points are from a line through `center` along an axis at most, and how far a segment of it about the centre
    /// has to reach so that a capsule that wide holds them: metres.
    pub(crate) fn capsule_along(&self, center: DVec3, axis: usize) -> [f64; 2] {
        let widest = self.lanes.run(Widest { rows: &self.rows, center, axis }).sqrt();
        [widest, self.lanes.run(Reach { rows: &self.rows, center, axis, widest })]
    }
}

/// The largest value so far in each lane, and in which row, the last of several.
#[derive(Clone, Copy)]
struct Best<V> {
    most: V,
    place: V,
}

impl<V: Lanes<Scalar = f64, Row = F64Row>> Best<V> {
    #[inline(always)]
    fn none(isa: V::Isa) -> Self {
        Self { most: V::constant(isa, f64::NEG_INFINITY), place: V::constant(isa, 0.0) }
    }

    #[inline(always)]
    fn look(&mut self, value: V, place: V) {
        let nearer = value.lt(self.most);
        self.most = V::select(nearer, self.most, value);
        self.place = V::select(nearer, self.place, place);
    }

    /// The largest of all lanes, and the number of its last point.
    #[inline(always)]
    fn last(self) -> (f64, usize) {
        let (mut values, mut places) = (F64Row::default(), F64Row::default());
        self.most.store(&mut values);
        self.place.store(&mut places);
        let most = self.most.most();
        let mut found = 0;
        for lane in 0..8 {
            if values.0[lane] == most {
                found = found.max(8 * places.0[lane] as usize + lane);
            }
        }
        (most, found)
    }
}

struct LastAlong<'a> {
    rows: &'a [[F64Row; 3]],
    d: DVec3,
}

impl Kernel for LastAlong<'_> {
    type Output = (f64, usize);

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> (f64, usize) {
        let d = Vector3::<I::F64>::splat(isa, self.d);
        let mut best = Best::<I::F64>::none(isa);
        for place in 0..self.rows.len() {
            let p = Vector3::<I::F64>::load(isa, &self.rows[place]);
            // Products and sums as one at a time has them, not fused.
            best.look(p.x * d.x + p.y * d.y + p.z * d.z, I::F64::constant(isa, place as f64));
        }
        best.last()
    }
}

struct LastFrom<'a> {
    rows: &'a [[F64Row; 3]],
    from: DVec3,
}

impl Kernel for LastFrom<'_> {
    type Output = (f64, usize);

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> (f64, usize) {
        let from = Vector3::<I::F64>::splat(isa, self.from);
        let mut best = Best::<I::F64>::none(isa);
        for place in 0..self.rows.len() {
            let p = Vector3::<I::F64>::load(isa, &self.rows[place]);
            let (x, y, z) = (p.x - from.x, p.y - from.y, p.z - from.z);
            best.look(x * x + y * y + z * z, I::F64::constant(isa, place as f64));
        }
        best.last()
    }
}

/// The square of how far a point is from the axis at most.
struct Widest<'a> {
    rows: &'a [[F64Row; 3]],
    center: DVec3,
    axis: usize,
}

impl Kernel for Widest<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f64 {
        let center = Vector3::<I::F64>::splat(isa, self.center);
        let mut most = I::F64::constant(isa, 0.0);
        for place in 0..self.rows.len() {
            let p = Vector3::<I::F64>::load(isa, &self.rows[place]);
            most = most.max(across::<I::F64>(p, center, self.axis).0);
        }
        most.most()
    }
}

struct Reach<'a> {
    rows: &'a [[F64Row; 3]],
    center: DVec3,
    axis: usize,
    widest: f64,
}

impl Kernel for Reach<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> f64 {
        let center = Vector3::<I::F64>::splat(isa, self.center);
        let (zero, square) = (I::F64::constant(isa, 0.0), I::F64::constant(isa, self.widest * self.widest));
        let mut most = zero;
        for place in 0..self.rows.len() {
            let p = Vector3::<I::F64>::load(isa, &self.rows[place]);
            let (across, along) = across::<I::F64>(p, center, self.axis);
            let across = across.sqrt();
            most = most.max(along.abs() - (square - across * across).max(zero).sqrt());
        }
        most.most()
    }
}

/// The square of a point's distance from the line along an axis, and where along it the point is.
#[inline(always)]
fn across<V: Lanes<Scalar = f64>>(p: Vector3<V>, center: Vector3<V>, axis: usize) -> (V, V) {
    let (x, y, z) = (p.x - center.x, p.y - center.y, p.z - center.z);
    match axis {
        0 => (y * y + z * z, x),
        1 => (x * x + z * z, y),
        _ => (x * x + y * y, z),
    }
}

impl PointRows {
    /// As [`Capsule::of`] has it for the points, along the longest side of a box that holds them.
    pub(crate) fn capsule(&self, center: DVec3, half: DVec3) -> Capsule {
        let axis = crate::collision::solids::volumes::longest_axis(half);
        let [widest, reach] = self.capsule_along(center, axis);
        Capsule::about(center, DVec3::AXES[axis] * reach, widest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::solids::volumes::farthest_of;

    /// Points on a coarse grid, so that many are equally far, some of them twice.
    fn points(count: usize) -> Vec<DVec3> {
        let mut state = 7_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from((state >> 24) as i32 % 7 - 3) * 0.1
        };
        (0..count).map(|_| DVec3::new(next(), next(), next())).collect()
    }

    #[test]
    fn the_last_of_the_farthest_is_found_at_every_level() {
        let directions = [DVec3::new(2.0, -1.0, 0.0), DVec3::Z * -2.0, DVec3::new(1.0, 2.0, 2.0)];
        for count in [1, 7, 8, 9, 64, 203] {
            let points = points(count);
            for lanes in Level::available() {
                let rows =
                    PointRows { lanes, ..PointRows::of(&points).unwrap_or_else(|| unreachable!("they are small")) };
                for d in directions {
                    let last = (0..count).max_by(|&a, &b| points[a].dot(d).total_cmp(&points[b].dot(d)));
                    let zero = last.is_some_and(|last| points[last].dot(d) == 0.0);
                    assert_eq!(rows.last_along(d), last.filter(|_| !zero), "{count} points, {lanes:?}");
                    let (found, square) = rows.last_from(d);
                    let one_by_one = |a: &usize, b: &usize| {
                        points[*a].distance_squared(d).total_cmp(&points[*b].distance_squared(d))
                    };
                    assert_eq!(Some(found), (0..count).max_by(one_by_one));
                    assert_eq!(square.sqrt().to_bits(), farthest_of(&points, d).distance(d).to_bits());
                }
            }
        }
    }

    #[test]
    fn a_capsule_is_that_of_one_point_after_another_at_every_level() {
        for (count, half) in [(5, DVec3::new(3.0, 2.0, 1.0)), (64, DVec3::new(1.0, 3.0, 2.0)), (203, DVec3::Z)] {
            let points = points(count);
            let center = DVec3::new(0.01, -0.02, 0.03);
            let one_by_one = Capsule::of_points(center, half, &points, 0.0);
            for lanes in Level::available() {
                let rows =
                    PointRows { lanes, ..PointRows::of(&points).unwrap_or_else(|| unreachable!("they are small")) };
                assert_eq!(format!("{:?}", rows.capsule(center, half)), format!("{one_by_one:?}"), "{lanes:?}");
            }
        }
    }

    #[test]
    fn numbers_that_are_too_large_are_left_to_others() {
        for x in [f64::NAN, f64::INFINITY, 1e200] {
            assert!(PointRows::of(&[DVec3::ONE, DVec3::new(0.0, x, 0.0)]).is_none());
        }
        assert!(PointRows::of(&[]).is_none());
    }
}
