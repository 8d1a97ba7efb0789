//! Up to four points, and the point of their convex hull that is closest to the origin: the inner step of GJK.

use glam::DVec3;

/// Triangles whose angles' sines square to less have no normal to speak of: they are edges.
const FLAT: f64 = 1e-20;

/// The simplex of GJK.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex {
    points: [DVec3; 4],
    count: usize,
}

/// What the closest point looks like.
pub(crate) enum Closest {
    /// It is this point; the simplex holds only the vertices that span it.
    Outside(DVec3),
    /// The origin lies inside the tetrahedron.
    Inside,
}

impl Simplex {
    pub(crate) fn of(point: DVec3) -> Self {
        Self { points: [point; 4], count: 1 }
    }

    /// Its vertices.
    pub(crate) fn points(&self) -> &[DVec3] {
        &self.points[..self.count]
    }

    /// Adds a vertex; false where it is already there (no progress is possible) or there is no room.
    pub(crate) fn add(&mut self, point: DVec3) -> bool {
        if self.count >= 4 || self.points[..self.count].contains(&point) {
            return false;
        }
        self.points[self.count] = point;
        self.count += 1;
        true
    }

    /// The point of the hull that is closest to the origin; drops the vertices that do not span it.
    pub(crate) fn reduce(&mut self) -> Closest {
        match self.count {
            1 => Closest::Outside(self.points[0]),
            2 => self.become_face(segment(self.points[0], self.points[1])),
            3 => self.become_face(triangle(self.points[0], self.points[1], self.points[2])),
            _ => match tetrahedron(&self.points) {
                Some(face) => self.become_face(face),
                None => Closest::Inside,
            },
        }
    }

    fn become_face(&mut self, face: Face) -> Closest {
        self.points[..face.count].copy_from_slice(&face.points[..face.count]);
        self.count = face.count;
        Closest::Outside(face.closest)
    }
}

/// A vertex, edge or triangle, and its point that is closest to the origin.
#[derive(Clone, Copy)]
struct Face {
    points: [DVec3; 3],
    count: usize,
    closest: DVec3,
}

fn vertex(a: DVec3) -> Face {
    Face { points: [a; 3], count: 1, closest: a }
}

fn edge(a: DVec3, b: DVec3, s: f64) -> Face {
    Face { points: [a, b, b], count: 2, closest: a + (b - a) * s }
}

fn segment(a: DVec3, b: DVec3) -> Face {
    let ab = b - a;
    let (along, length) = (-a.dot(ab), ab.length_squared());
    if along <= 0.0 {
        vertex(a)
    } else if along >= length {
        vertex(b)
    } else {
        edge(a, b, along / length)
    }
}

/// The point of a triangle that is closest to the origin.
pub(crate) fn closest_of_triangle(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    triangle(a, b, c).closest
}

/// By Voronoi regions (Ericson, Real-Time Collision Detection, §5.1.5).
fn triangle(a: DVec3, b: DVec3, c: DVec3) -> Face {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return vertex(a);
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return vertex(b);
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return vertex(c);
    }
    // Signed areas from the normal: cancellation in products of dot products would lose flat triangles.
    let n = ab.cross(ac);
    let square = n.length_squared();
    if square <= FLAT * ab.length_squared() * ac.length_squared() {
        return best([segment(a, b), segment(b, c), segment(c, a)]);
    }
    let (va, vb, vc) = (n.dot(b.cross(c)), n.dot(c.cross(a)), n.dot(a.cross(b)));
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return edge(a, b, d1 / (d1 - d3));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return edge(a, c, d2 / (d2 - d6));
    }
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return edge(b, c, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    if va > 0.0 && vb > 0.0 && vc > 0.0 {
        // The foot of the perpendicular, along the normal: exact in direction even for slivers.
        return Face { points: [a, b, c], count: 3, closest: n * (n.dot(a) / square) };
    }
    best([segment(a, b), segment(b, c), segment(c, a)])
}

fn best<const N: usize>(faces: [Face; N]) -> Face {
    let mut least = faces[0];
    for face in &faces[1..] {
        if face.closest.length_squared() < least.closest.length_squared() {
            least = *face;
        }
    }
    least
}

/// The face that is closest to the origin, or none where the origin is inside.
fn tetrahedron(points: &[DVec3; 4]) -> Option<Face> {
    let mut least: Option<Face> = None;
    // The newest vertex is last: only the faces that hold it can be closest, the fourth was the simplex before it came;
    // it is tested all the same, since a flat tetrahedron has no inside to tell.
    for [i, j, k, l] in [[0, 1, 3, 2], [1, 2, 3, 0], [2, 0, 3, 1], [0, 1, 2, 3]] {
        let (a, b, c, d) = (points[i], points[j], points[k], points[l]);
        let n = (b - a).cross(c - a);
        let (apex, origin) = (n.dot(d - a), -n.dot(a));
        let flat = apex.abs() <= 1e-12 * n.length() * (d - a).length();
        if flat || apex * origin <= 0.0 {
            let face = triangle(a, b, c);
            if least.is_none_or(|l| face.closest.length_squared() < l.closest.length_squared()) {
                least = Some(face);
            }
        }
    }
    least
}
