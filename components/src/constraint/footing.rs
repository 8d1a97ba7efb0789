//! Which points of an object must be over its support, by the rule that its placement follows.

use crate::constraint::placement::{Placement, PlacementError, Polygon};
use crate::constraint::rests::Rests;
use glam::{DVec2, DVec3, Vec3Swizzles};

impl Placement {
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
    fn an_object_that_would_always_tip_over_is_refused() {
        let refused = placement().resting(Rests::Stable { margin: 0.005 }, Some(DVec3::X * 0.097));
        assert!(matches!(refused, Err(PlacementError::NeverStable { inside, .. }) if (inside - 0.003).abs() < 1e-12));
        assert!(placement().resting(Rests::Stable { margin: f64::NAN }, None).is_err());
    }
}
