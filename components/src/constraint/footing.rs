//! Which points of an object must be over its support, by the rule that its placement follows.

use crate::constraint::placement::{Placement, PlacementError, Polygon};
use crate::constraint::rests::Rests;
use glam::{DVec2, DVec3, Vec3Swizzles};

/// By so much a support has to be too small before it is called that, metres: more than any tolerance of placements.
const TOO_SMALL: f64 = 1e-3;

impl Placement {
    /// Whether the sizes of the polygons leave any way to rest: `false` is a proof. What has to be over a support is no wider and no longer than
    /// the support, less the margin on either side.
    #[must_use]
    pub fn may_rest(&self) -> bool {
        let margin = self.rests.margin();
        let fits = |points: &Vec<DVec2>| {
            let needs = [least_width(points), diameter(points)].map(|size| size + 2.0 * margin - TOO_SMALL);
            let has = |support: &Polygon| [least_width(&support.vertices), diameter(&support.vertices)];
            !points.is_empty()
                && self.supports.iter().any(|support| has(support).iter().zip(&needs).all(|(h, n)| h >= n))
        };
        self.footings.is_empty() || self.footings.iter().any(fits)
    }

    /// The same under another rule. `centre_of_mass` is the object's, metres in the frame of the body that carries its polygons;
    /// without it each polygon's own centre stands for it. Only [`Rests::Stable`] asks for it.
    ///
    /// # Errors
    /// A margin that is not finite; an object whose centre of mass is over none of its polygons.
    pub fn resting(mut self, rests: Rests, centre_of_mass: Option<DVec3>) -> Result<Self, PlacementError> {
        let margin = rests.margin();
        if !margin.is_finite() {
            return Err(PlacementError::Margin(margin));
        }
        self.rests = rests;
        self.footings = match rests {
            Rests::Centre => Vec::new(),
            Rests::WholeFace { .. } => self.object.iter().map(|polygon| polygon.vertices.clone()).collect(),
            Rests::Stable { .. } => {
                let over = |polygon: &Polygon| {
                    let in_frame = |c| polygon.frame.joint_from_frame.inverse_transform_point(c);
                    let at = centre_of_mass.map_or(DVec2::ZERO, |c| in_frame(c).yz());
                    (polygon.signed_distance(at), at)
                };
                let found: Vec<_> = self.object.iter().map(over).collect();
                let inside = -found.iter().map(|(beyond, _)| *beyond).fold(f64::INFINITY, f64::min);
                if inside < margin {
                    return Err(PlacementError::NeverStable { inside, margin });
                }
                let points = |(beyond, at): (f64, DVec2)| if -beyond >= margin { vec![at] } else { Vec::new() };
                found.into_iter().map(points).collect()
            }
        };
        Ok(self)
    }
}

/// Of the strips between parallel lines that hold a convex polygon the narrowest is flush with a side.
fn least_width(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let across = |(a, b): (&DVec2, &DVec2)| {
        let normal = (*b - *a).perp().try_normalize()?;
        Some(corners.iter().map(|c| normal.dot(*c - *a).abs()).fold(0.0, f64::max))
    };
    corners.iter().zip(next).filter_map(across).min_by(f64::total_cmp).unwrap_or(0.0)
}

fn diameter(corners: &[DVec2]) -> f64 {
    corners.iter().flat_map(|a| corners.iter().map(|b| a.distance(*b))).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pose;
    use crate::constraint::{Frame, Side};

    /// Two faces of a body: a large one and one of 8 mm.
    fn placement() -> Placement {
        let square = |half: f64, side| {
            let corners = [(half, half), (-half, half), (-half, -half), (half, -half)];
            let points = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
            Polygon::new(Frame::world(Pose::identity()), &points, side).unwrap()
        };
        let object = vec![square(0.1, Side::Object), square(0.004, Side::Object)];
        Placement::from_polygons(object, vec![square(1.0, Side::Support)], 0.001).unwrap()
    }

    #[test]
    fn what_must_be_over_the_support_follows_the_rule() {
        assert!(placement().footings.is_empty());
        let whole = placement().resting(Rests::WholeFace { margin: 0.0 }, None).unwrap();
        assert_eq!(whole.footings[0], whole.object[0].vertices);
        let centre = DVec3::new(0.03, -0.02, 0.4);
        let stable = placement().resting(Rests::Stable { margin: 0.005 }, Some(centre)).unwrap();
        let footing = stable.footings[0][0];
        let back = stable.object[0].frame.joint_from_frame.transform_point(DVec3::new(0.0, footing.x, footing.y));
        assert!((back - DVec3::new(0.03, -0.02, 0.0)).length() < 1e-12);
        assert!(stable.footings[1].is_empty(), "nothing rests on a face that the centre of mass is not over");
    }

    #[test]
    fn supports_that_are_too_small_are_told_by_their_sizes() {
        let face = |width: f64, length: f64, side| {
            let (x, y) = (width / 2.0, length / 2.0);
            let points = [(x, y), (-x, y), (-x, -y), (x, -y)].map(|(x, y)| DVec3::new(x, y, 0.0));
            Polygon::new(Frame::world(Pose::identity()), &points, side).unwrap()
        };
        let on = |width, length, rests| {
            let polygons = (vec![face(0.1, 0.2, Side::Object)], vec![face(width, length, Side::Support)]);
            let placement = Placement::from_polygons(polygons.0, polygons.1, 0.001).unwrap();
            placement.resting(rests, Some(DVec3::ZERO)).unwrap().may_rest()
        };
        let (whole, stable) = (Rests::WholeFace { margin: 0.01 }, Rests::Stable { margin: 0.01 });
        for (width, length, is_whole, is_stable) in
            [(0.12, 0.22, true, true), (0.5, 0.117, false, true), (0.15, 0.15, false, true), (1.0, 0.018, false, false)]
        {
            assert_eq!(
                (on(width, length, whole), on(width, length, stable)),
                (is_whole, is_stable),
                "{width} {length}"
            );
        }
        assert!(on(0.001, 0.001, Rests::Centre), "nothing is proved of the rule of centres");
    }

    #[test]
    fn an_object_that_would_always_tip_over_is_refused() {
        let refused = placement().resting(Rests::Stable { margin: 0.005 }, Some(DVec3::X * 0.097));
        assert!(matches!(refused, Err(PlacementError::NeverStable { inside, .. }) if (inside - 0.003).abs() < 1e-12));
        assert!(placement().resting(Rests::Stable { margin: f64::NAN }, None).is_err());
    }
}
