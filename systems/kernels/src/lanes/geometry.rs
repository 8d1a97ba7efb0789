//! Vectors, rotations and rigid motions of every lane.

use super::vector::Lanes;
use foliate_components::Pose;
use glam::{DMat3, DVec3};

/// A vector per lane.
#[derive(Clone, Copy, Debug)]
pub struct Vector3<V> {
    /// First component.
    pub x: V,
    /// Second component.
    pub y: V,
    /// Third component.
    pub z: V,
}

/// A rotation matrix per lane, by columns: the axes of the turned frame.
#[derive(Clone, Copy, Debug)]
pub struct Rotation<V> {
    /// Columns.
    pub columns: [Vector3<V>; 3],
}

/// A rigid motion per lane.
#[derive(Clone, Copy, Debug)]
pub struct Transform<V> {
    /// Rotation.
    pub rotation: Rotation<V>,
    /// Translation.
    pub translation: Vector3<V>,
}

impl<V: Lanes> Vector3<V> {
    /// From its components.
    #[inline(always)]
    pub fn new(x: V, y: V, z: V) -> Self {
        Self { x, y, z }
    }

    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(isa: V::Isa, v: DVec3) -> Self {
        Self::new(V::constant(isa, v.x), V::constant(isa, v.y), V::constant(isa, v.z))
    }

    /// From three rows of memory.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn load(isa: V::Isa, rows: &[V::Row]) -> Self {
        let rows = &rows[..3];
        Self::new(V::load(isa, &rows[0]), V::load(isa, &rows[1]), V::load(isa, &rows[2]))
    }

    /// To three rows of memory.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn store(self, rows: &mut [V::Row]) {
        let rows = &mut rows[..3];
        self.x.store(&mut rows[0]);
        self.y.store(&mut rows[1]);
        self.z.store(&mut rows[2]);
    }

    /// self + v.
    #[inline(always)]
    pub fn plus(self, v: Self) -> Self {
        Self::new(self.x + v.x, self.y + v.y, self.z + v.z)
    }

    /// self − v.
    #[inline(always)]
    pub fn minus(self, v: Self) -> Self {
        Self::new(self.x - v.x, self.y - v.y, self.z - v.z)
    }

    /// −self.
    #[inline(always)]
    pub fn negated(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }

    /// self · s.
    #[inline(always)]
    pub fn scaled(self, s: V) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }

    /// self · s + v.
    #[inline(always)]
    pub fn scaled_plus(self, s: V, v: Self) -> Self {
        Self::new(self.x.mul_add(s, v.x), self.y.mul_add(s, v.y), self.z.mul_add(s, v.z))
    }

    /// v − self · s.
    #[inline(always)]
    pub fn scaled_from(self, s: V, v: Self) -> Self {
        Self::new(self.x.neg_mul_add(s, v.x), self.y.neg_mul_add(s, v.y), self.z.neg_mul_add(s, v.z))
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, v: Self) -> V {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z * v.z))
    }

    /// self × v.
    #[inline(always)]
    pub fn cross(self, v: Self) -> Self {
        Self::new(
            self.y.mul_sub(v.z, self.z * v.y),
            self.z.mul_sub(v.x, self.x * v.z),
            self.x.mul_sub(v.y, self.y * v.x),
        )
    }

    /// Where the mask is set `yes`, elsewhere `no`.
    #[inline(always)]
    pub fn select(mask: V::Mask, yes: Self, no: Self) -> Self {
        Self::new(V::select(mask, yes.x, no.x), V::select(mask, yes.y, no.y), V::select(mask, yes.z, no.z))
    }
}

impl<V: Lanes> Rotation<V> {
    /// The same rotation in every lane.
    #[inline(always)]
    pub fn splat(isa: V::Isa, r: &DMat3) -> Self {
        Self { columns: [Vector3::splat(isa, r.x_axis), Vector3::splat(isa, r.y_axis), Vector3::splat(isa, r.z_axis)] }
    }

    /// From nine rows of memory, column after column.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn load(isa: V::Isa, rows: &[V::Row]) -> Self {
        let rows = &rows[..9];
        Self {
            columns: [Vector3::load(isa, &rows[..3]), Vector3::load(isa, &rows[3..6]), Vector3::load(isa, &rows[6..])],
        }
    }

    /// To nine rows of memory, column after column.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn store(self, rows: &mut [V::Row]) {
        let rows = &mut rows[..9];
        self.columns[0].store(&mut rows[..3]);
        self.columns[1].store(&mut rows[3..6]);
        self.columns[2].store(&mut rows[6..]);
    }

    /// From unit quaternions.
    #[inline(always)]
    pub fn from_quaternion(x: V, y: V, z: V, w: V) -> Self {
        let one = V::constant(x.isa(), 1.0);
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (xy, xz, yz) = (x * y2, x * z2, y * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        Self {
            columns: [
                Vector3::new(one - (yy + zz), xy + wz, xz - wy),
                Vector3::new(xy - wz, one - (xx + zz), yz + wx),
                Vector3::new(xz + wy, yz - wx, one - (xx + yy)),
            ],
        }
    }

    /// R · v.
    #[inline(always)]
    pub fn turn(&self, v: Vector3<V>) -> Vector3<V> {
        let [a, b, c] = self.columns;
        a.scaled_plus(v.x, b.scaled_plus(v.y, c.scaled(v.z)))
    }

    /// Rᵀ · v.
    #[inline(always)]
    pub fn turn_back(&self, v: Vector3<V>) -> Vector3<V> {
        let [a, b, c] = self.columns;
        Vector3::new(a.dot(v), b.dot(v), c.dot(v))
    }

    /// self · other.
    #[inline(always)]
    pub fn times(&self, other: &Self) -> Self {
        let [a, b, c] = other.columns;
        Self { columns: [self.turn(a), self.turn(b), self.turn(c)] }
    }

    /// selfᵀ · other.
    #[inline(always)]
    pub fn transpose_times(&self, other: &Self) -> Self {
        let [a, b, c] = other.columns;
        Self { columns: [self.turn_back(a), self.turn_back(b), self.turn_back(c)] }
    }
}

impl<V: Lanes> Transform<V> {
    /// The same motion in every lane.
    #[inline(always)]
    pub fn splat(isa: V::Isa, pose: &Pose) -> Self {
        Self {
            rotation: Rotation::splat(isa, &DMat3::from_quat(pose.rotation)),
            translation: Vector3::splat(isa, pose.translation),
        }
    }

    /// From twelve rows of memory: columns of the rotation, then the translation.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn load(isa: V::Isa, rows: &[V::Row]) -> Self {
        let rows = &rows[..12];
        Self { rotation: Rotation::load(isa, &rows[..9]), translation: Vector3::load(isa, &rows[9..]) }
    }

    /// To twelve rows of memory: columns of the rotation, then the translation.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub fn store(self, rows: &mut [V::Row]) {
        let rows = &mut rows[..12];
        self.rotation.store(&mut rows[..9]);
        self.translation.store(&mut rows[9..]);
    }

    /// R · p + t.
    #[inline(always)]
    pub fn point(&self, p: Vector3<V>) -> Vector3<V> {
        let [a, b, c] = self.rotation.columns;
        a.scaled_plus(p.x, b.scaled_plus(p.y, c.scaled_plus(p.z, self.translation)))
    }

    /// self · other.
    #[inline(always)]
    pub fn times(&self, other: &Self) -> Self {
        Self { rotation: self.rotation.times(&other.rotation), translation: self.point(other.translation) }
    }
}
