//! What lies inside a solid with certainty: where two such sets overlap, the solids do, and nothing exact need be asked.
//!
//! Every solid but an open mesh has a capsule inside of it: along its longest side, as thick as its thinnest, for a box or a
//! cylinder; a ball for a closed mesh. A point of one's axis that is deeper inside the other than the capsule's radius shows
//! the overlap, whichever point it is; tried are those where the two axes come closest. Against a convex solid the point is measured
//! exactly, so that only one of the two has to be slender.
//!
//! A pair counts as colliding with certainty where the overlap exceeds rounding. The exact query, which gives lower bounds of distances, then gives
//! one that is not positive, or, where a mesh lies all inside or around the other solid, the question of containment says yes: an
//! odd number of crossings cannot change along a way that meets no triangle.

use crate::collision::convex::core::{Convex, Core};
use crate::collision::convex::gjk::{DistanceQuery, ROUNDING, Relative};
use crate::collision::distance::mesh_distance::mesh_convex_distance;
use crate::collision::solids::mesh_tree::MeshTree;
use crate::collision::solids::solid::Solid;
use crate::collision::solids::volumes::{Ball, Capsule};
use foliate_components::Pose;
use glam::{DMat3, DVec3};

/// Overlaps up to here may be rounding, metres.
pub(crate) const SURE: f64 = 10.0 * ROUNDING;

/// A set inside of a solid.
#[derive(Clone, Debug)]
pub(crate) struct InscribedVolume {
    /// A capsule, in the frame of the solid's body or in the world.
    pub(crate) capsule: Capsule,
    /// For bounds in lanes, in single precision: its middle in the frame of the bounding volume's axes, from their centre, and along which
    /// of these axes it lies.
    pub middle: [f32; 3],
    pub along: usize,
    pub half_length: f32,
    pub radius: f32,
    /// Whether the bounding volume is the solid itself.
    pub fills: bool,
}

impl InscribedVolume {
    /// Of a solid at `X_JS` in its body's frame; none where it bounds no volume.
    pub(crate) fn of(solid: &Solid, X_JS: &Pose) -> Option<Self> {
        let (capsule, along, middle) = match solid {
            Solid::Convex(convex) => {
                let (capsule, along) = in_convex(convex)?;
                (capsule, along, DVec3::ZERO)
            }
            Solid::Mesh(mesh) => {
                let ball = ball_in(mesh)?;
                let center = mesh.bounds()?.center;
                let capsule = Capsule { middle: ball.center, half: DVec3::ZERO, radius: ball.radius };
                (capsule, 2, ball.center - center)
            }
        };
        Some(Self {
            capsule: capsule.moved(X_JS),
            middle: [middle.x as f32, middle.y as f32, middle.z as f32],
            along,
            half_length: capsule.half.length() as f32,
            radius: capsule.radius as f32,
            fills: matches!(solid, Solid::Convex(convex) if convex.radius == 0.0),
        })
    }
}

/// Along the longest side, as thick as the thinnest; also which of the axes that is.
fn in_convex(convex: &Convex) -> Option<(Capsule, usize)> {
    let half = match convex.core {
        Core::Point => DVec3::ZERO,
        Core::Segment { half_length } => DVec3::Z * half_length,
        Core::Box { half_extents } => half_extents,
        Core::Cylinder { radius, half_length } => DVec3::new(radius, radius, half_length),
        Core::Triangle(_) => return None,
    };
    let along = half.max_position();
    let thinnest = half.min_element();
    let length = DVec3::AXES[along] * (half[along] - thinnest);
    Some((Capsule { middle: DVec3::ZERO, half: length, radius: thinnest + convex.radius }, along))
}

/// How often a step is halved on the way to the middle of a mesh.
const HALVINGS: u32 = 3;

/// A large ball inside a closed mesh; none where no point was found that is inside beyond doubt.
fn ball_in(mesh: &MeshTree) -> Option<Ball> {
    let around = mesh.bounds().filter(|around| mesh.is_closed() && around.half.is_finite())?;
    let mut best = deeper(mesh, around.center, None);
    for corner in 0..8_u32 {
        let side = |bit: u32| if corner >> bit & 1 == 1 { 0.5 } else { -0.5 };
        best = deeper(mesh, around.center + around.half * DVec3::new(side(0), side(1), side(2)), best);
    }
    let mut step = 0.25;
    for _ in 0..HALVINGS {
        let Ball { center, .. } = best?;
        for axis in DVec3::AXES {
            for side in [step, -step] {
                best = deeper(mesh, center + around.half * axis * side, best);
            }
        }
        if best.is_some_and(|ball| ball.center == center) {
            step *= 0.5;
        }
    }
    best
}

/// The ball about a point, where it is inside and larger than the best one so far.
fn deeper(mesh: &MeshTree, center: DVec3, best: Option<Ball>) -> Option<Ball> {
    let least = best.map_or(SURE, |ball| ball.radius);
    // Nothing inside is farther from the surface than from the sides of the box around it.
    let around = mesh.bounds()?;
    let to_side = (around.half - (center - around.center).abs()).min_element();
    if to_side <= least || !mesh.surely_contains(center) {
        return best;
    }
    let point = Convex { core: Core::Point, radius: 0.0 };
    let here = Relative { rotation: DMat3::IDENTITY, translation: center };
    let radius = mesh_convex_distance(mesh, &point, &here, DistanceQuery::exact(to_side), &mut DVec3::ZERO.clone());
    if radius > least { Some(Ball { center, radius }) } else { best }
}
