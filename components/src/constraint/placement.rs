//! An object lies on a support: convex planar polygons in contact (P0 §II-C.1, eq. 3–5).
//!
//! Frames, pair selection and rows are HPP's (they differ from the paper's wording where that is ambiguous): the frame
//! of a polygon has its origin in the mean of the vertices, x along the normal, z along the first edge and y outward
//! across that edge. A support is read with its vertices reversed, so that its x points *into* the support and, at
//! contact, the x axes of both frames coincide; only the turn about x is free then.

use super::Frame;
use crate::Pose;
use crate::constraint::rests::Rests;
use crate::robot::hybrid_robot::{Robot, Surface};
use crate::robot::indices::{JointIndex, SurfaceIndex};
use glam::{DMat3, DQuat, DVec2, DVec3, Vec3Swizzles};

/// A convex planar polygon on a body, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The polygon's frame on its body.
    pub frame: Frame,
    /// Vertices in the (y, z) plane of that frame, metres, in the order in which they were read (a support's: reversed).
    pub vertices: Vec<DVec2>,
    /// For each edge (from the vertex of the same number to the next) its unit normal in the plane, pointing out.
    pub normals: Vec<DVec2>,
    /// Radius about the origin of the smallest disc that holds the polygon, metres.
    pub radius: f64,
}

/// Whether a polygon belongs to what lies or to what it lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// x points out of the solid.
    Object,
    /// x points into the solid.
    Support,
}

/// Object polygons that may touch support polygons.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Polygons of the object, all on one body; not empty.
    pub object: Vec<Polygon>,
    /// Polygons that may carry it, on any bodies; not empty.
    pub supports: Vec<Polygon>,
    /// Gap between the two planes, metres: x = −margin at contact (P0's ε).
    pub margin: f64,
    /// M: more than the radius of every support polygon. The complement stores which pair touches as multiples of 2M.
    pub stride: f64,
    /// How the object must lie. [`Placement::resting`] sets it.
    pub rests: Rests,
    /// What must be over the support by the margin of `rests`, for each of the object's polygons: points in the (y, z) plane of its
    /// frame, metres. Of a polygon on which the object cannot rest there are none. Empty under [`Rests::Centre`].
    pub footings: Vec<Vec<DVec2>>,
}

/// Why surfaces make no placement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages are the documentation")]
pub enum PlacementError {
    #[error("surface `{surface}`, polygon {polygon}: {problem}")]
    Polygon { surface: String, polygon: usize, problem: &'static str },
    #[error("a placement needs at least one polygon of the object and one of a support")]
    Empty,
    #[error("surfaces `{first}` and `{second}` are on different bodies; an object's must be on one")]
    SeveralBodies { first: String, second: String },
    #[error("the object's polygons are on different bodies")]
    ObjectOnSeveralBodies,
    #[error("the margin {0} is not a finite number of metres")]
    Margin(f64),
    #[error(
        "it cannot rest stably on any of its polygons: the centre of mass is at best {:.2} mm inside of one, and {:.2} mm are asked; \
         rests = \"centre\" does not ask for the centre of mass",
        inside * 1e3, margin * 1e3
    )]
    NeverStable { inside: f64, margin: f64 },
}

impl Placement {
    /// Reads the surfaces' polygons.
    ///
    /// # Errors
    /// No polygons, polygons that are not convex and planar, object surfaces on several bodies, a margin that is not finite.
    ///
    /// # Panics
    /// If the robot has no such surface.
    pub fn new(
        robot: &Robot,
        object: &[SurfaceIndex],
        supports: &[SurfaceIndex],
        margin: f64,
    ) -> Result<Self, PlacementError> {
        let surface = |index: &SurfaceIndex| &robot.surfaces[index.at()];
        if let Some((first, second)) = on_different_bodies(robot, object) {
            let name = |index: SurfaceIndex| robot.surfaces[index.at()].name.clone();
            return Err(PlacementError::SeveralBodies { first: name(first), second: name(second) });
        }
        let collect = |indices: &[SurfaceIndex], side| -> Result<Vec<Polygon>, PlacementError> {
            let mut polygons = Vec::new();
            for index in indices {
                polygons.extend(Polygon::of_surface(robot, surface(index), side)?);
            }
            Ok(polygons)
        };
        Self::from_polygons(collect(object, Side::Object)?, collect(supports, Side::Support)?, margin)
    }

    /// A placement of polygons that are already read.
    ///
    /// # Errors
    /// No polygons, object polygons on several bodies, or a margin that is not finite.
    pub fn from_polygons(object: Vec<Polygon>, supports: Vec<Polygon>, margin: f64) -> Result<Self, PlacementError> {
        if !margin.is_finite() {
            return Err(PlacementError::Margin(margin));
        }
        if object.is_empty() || supports.is_empty() {
            return Err(PlacementError::Empty);
        }
        if object.iter().any(|polygon| polygon.frame.joint != object[0].frame.joint) {
            return Err(PlacementError::ObjectOnSeveralBodies);
        }
        let stride = 1.0 + supports.iter().map(|p| p.radius).fold(0.0, f64::max);
        Ok(Self { object, supports, margin, stride, rests: Rests::Centre, footings: Vec::new() })
    }

    /// The same, lifted by `distance` metres along the support's normal: the pre-placement.
    #[must_use]
    pub fn lifted(&self, distance: f64) -> Self {
        Self { margin: self.margin + distance, ..self.clone() }
    }

    /// The body that carries the object's polygons; `None` where that is the world.
    #[must_use]
    pub fn object_joint(&self) -> Option<JointIndex> {
        self.object.first().and_then(|p| p.frame.joint)
    }

    /// The body of the supports, where all of them are on one (`Some(None)`: the world).
    #[must_use]
    pub fn only_support(&self) -> Option<Option<JointIndex>> {
        let first = self.supports.first()?.frame.joint;
        self.supports.iter().all(|p| p.frame.joint == first).then_some(first)
    }
}

fn on_different_bodies(robot: &Robot, surfaces: &[SurfaceIndex]) -> Option<(SurfaceIndex, SurfaceIndex)> {
    let body = |index: &SurfaceIndex| robot.links[robot.surfaces[index.at()].link.at()].joint;
    let first = surfaces.first()?;
    let other = surfaces.iter().find(|index| body(index) != body(first))?;
    Some((*first, *other))
}

impl Polygon {
    /// All polygons of a surface.
    ///
    /// # Errors
    /// A polygon that is not convex and planar.
    pub fn of_surface(robot: &Robot, surface: &Surface, side: Side) -> Result<Vec<Self>, PlacementError> {
        let body = Frame::on_link(robot, surface.link, &Pose::identity());
        let polygon = |(number, indices): (usize, &Vec<u32>)| {
            let failed = |problem| PlacementError::Polygon { surface: surface.name.clone(), polygon: number, problem };
            let mut points = Vec::with_capacity(indices.len());
            for &index in indices {
                points.push(*surface.points.get(index as usize).ok_or_else(|| failed("names a missing point"))?);
            }
            Self::new(body, &points, side).map_err(failed)
        };
        surface.polygons.iter().enumerate().map(polygon).collect()
    }

    /// A polygon from its vertices in the frame `body`, counter-clockwise seen from outside the solid.
    ///
    /// # Errors
    /// Fewer than three vertices, numbers that are not finite, edges of no length, vertices off a common plane by more
    /// than a thousandth of the polygon's size, or a corner that turns inwards.
    pub fn new(body: Frame, points: &[DVec3], side: Side) -> Result<Self, &'static str> {
        let mut points = points.to_vec();
        if side == Side::Support {
            points.reverse();
        }
        if points.len() < 3 {
            return Err("has fewer than three vertices");
        }
        if !points.iter().all(|p| p.is_finite()) {
            return Err("has a vertex that is not finite");
        }
        let center = points.iter().sum::<DVec3>() / points.len() as f64;
        let z = (points[1] - points[0]).try_normalize().ok_or("has two equal vertices")?;
        let corner = (points[1] - points[0]).cross(points[2] - points[1]);
        let x = corner.try_normalize().ok_or("has three vertices on a line at its first corner")?;
        let axes = DMat3::from_cols(x, z.cross(x), z);
        let local: Vec<DVec3> = points.iter().map(|&p| axes.transpose() * (p - center)).collect();
        let radius = local.iter().map(|p| p.yz().length()).fold(0.0, f64::max);
        if local.iter().any(|p| p.x.abs() > 1e-3 * radius) {
            return Err("is not planar");
        }
        let vertices: Vec<DVec2> = local.iter().map(|p| p.yz()).collect();
        let normals = outward_normals(&vertices)?;
        let rotation = DQuat::from_mat3(&axes).normalize();
        Ok(Self { frame: body.then(&Pose::from_parts(center, rotation)), vertices, normals, radius })
    }

    /// Signed distance in the plane from the polygon's boundary to the point (y, z), metres; negative inside.
    #[must_use]
    pub fn signed_distance(&self, point: DVec2) -> f64 {
        let beyond = |k: usize| self.normals[k].dot(point - self.vertices[k]);
        let edges = 0..self.vertices.len();
        let deepest = edges.clone().map(beyond).fold(f64::NEG_INFINITY, f64::max);
        if deepest <= 0.0 {
            return deepest;
        }
        let to_edge = |k: usize| {
            let (start, end) = (self.vertices[k], self.vertices[(k + 1) % self.vertices.len()]);
            let along = (end - start).dot(point - start) / (end - start).length_squared();
            point.distance(start.lerp(end, along.clamp(0.0, 1.0)))
        };
        edges.map(to_edge).fold(f64::INFINITY, f64::min)
    }
}

/// Normals of the edges. The frame's x axis is the polygon's normal, so the polygon runs counter-clockwise in (y, z) and
/// its outside lies to the right of every edge.
fn outward_normals(vertices: &[DVec2]) -> Result<Vec<DVec2>, &'static str> {
    let count = vertices.len();
    let edge = |k: usize| vertices[(k + 1) % count] - vertices[k];
    let mut normals = Vec::with_capacity(count);
    let mut turned = 0.0;
    for k in 0..count {
        let (this, next) = (edge(k), edge((k + 1) % count));
        let direction = this.try_normalize().ok_or("has two equal vertices")?;
        let sine = direction.perp_dot(next.normalize_or_zero());
        if sine < -1e-6 {
            return Err("is not convex");
        }
        turned += sine.atan2(direction.dot(next.normalize_or_zero()));
        normals.push(-direction.perp());
    }
    // A star winds around more than once although every corner turns the same way.
    if (turned - std::f64::consts::TAU).abs() > 1e-3 { Err("is not convex") } else { Ok(normals) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: Side) -> Polygon {
        let points = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 0.5));
        Polygon::new(Frame::world(Pose::identity()), &points, side).unwrap()
    }

    #[test]
    fn an_objects_x_points_out_and_a_supports_in() {
        for (side, normal) in [(Side::Object, DVec3::Z), (Side::Support, DVec3::NEG_Z)] {
            let pose = square(side).frame.joint_from_frame;
            assert!((pose.rotation * DVec3::X - normal).length() < 1e-15);
            assert!((pose.translation - DVec3::Z * 0.5).length() < 1e-15);
        }
        // y crosses the first edge outwards: it runs along y = 1 from x = 1 to x = −1.
        assert!((square(Side::Object).frame.joint_from_frame.rotation * DVec3::Y - DVec3::Y).length() < 1e-15);
    }

    #[test]
    fn the_distance_is_negative_inside_and_euclidean_outside() {
        for side in [Side::Object, Side::Support] {
            let square = square(side);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
            assert!(close(square.signed_distance(DVec2::new(0.7, 0.0)), -0.3));
            assert!(close(square.signed_distance(DVec2::new(0.0, -1.5)), 0.5));
            assert!(close(square.signed_distance(DVec2::new(4.0, 5.0)), 5.0));
        }
    }

    #[test]
    fn what_is_no_convex_polygon_is_refused() {
        let refused = |points: &[(f64, f64, f64)]| {
            let points: Vec<_> = points.iter().map(|&(x, y, z)| DVec3::new(x, y, z)).collect();
            Polygon::new(Frame::world(Pose::identity()), &points, Side::Object).unwrap_err()
        };
        assert_eq!(refused(&[(0., 0., 0.), (1., 0., 0.)]), "has fewer than three vertices");
        assert_eq!(refused(&[(0., 0., 0.), (1., 0., 0.), (1., 1., 0.), (0., 1., 0.5)]), "is not planar");
        assert_eq!(refused(&[(0., 0., 0.), (2., 0., 0.), (2., 2., 0.), (1.8, 0.1, 0.)]), "is not convex");
        assert_eq!(refused(&[(0., 0., 0.), (0., 0., 0.), (1., 1., 0.)]), "has two equal vertices");
        assert_eq!(refused(&[(f64::NAN, 0., 0.), (0., 1., 0.), (1., 1., 0.)]), "has a vertex that is not finite");
    }
}
