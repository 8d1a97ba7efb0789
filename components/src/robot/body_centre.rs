//! Where the mass of a body of a part is.

use crate::robot::hybrid_robot::Robot;
use crate::robot::indices::{JointIndex, PartIndex};
use glam::DVec3;

/// What a centre of mass was found from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CentreSource {
    /// The masses of the links.
    Masses,
    /// The volume of the collision shapes, as if they were all of one density: no link has a mass.
    Volume,
}

impl Robot {
    /// The centre of mass of those links of a part that `joint` moves as one body, metres in that joint's frame, and what it was
    /// found from. `None` where there is neither mass nor volume. Links beyond further joints are not part of it.
    ///
    /// # Panics
    /// If the robot has no such part.
    #[must_use]
    pub fn body_centre(&self, part: PartIndex, joint: Option<JointIndex>) -> Option<(DVec3, CentreSource)> {
        let on_body = |link: &&crate::robot::hybrid_robot::Link| link.part == part && link.joint == joint;
        let mean = |weighted: &mut dyn Iterator<Item = (f64, DVec3)>| {
            let (weight, moment) =
                weighted.fold((0.0, DVec3::ZERO), |(w, m), (weight, at)| (w + weight, m + weight * at));
            Some(moment / weight).filter(|centre| weight > 0.0 && centre.is_finite())
        };
        let masses = self.links.iter().filter(on_body).filter_map(|link| {
            let inertial = link.inertial?;
            Some((inertial.mass, link.joint_from_link.transform_point(inertial.center)))
        });
        if let Some(centre) = mean(&mut masses.into_iter()) {
            return Some((centre, CentreSource::Masses));
        }
        let volumes = self.shapes.iter().filter(|shape| on_body(&&self.links[shape.link.at()])).filter_map(|shape| {
            let (volume, centre) = shape.geometry.volume()?;
            Some((volume, shape.joint_from_shape.transform_point(centre)))
        });
        mean(&mut volumes.into_iter()).map(|centre| (centre, CentreSource::Volume))
    }
}
