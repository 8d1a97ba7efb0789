//! What the exact queries say of one pair at one sample of a motion.

use crate::collision::convex::gjk::DistanceQuery;
use crate::collision::narrow_phase::settings::CertificateSettings;
use crate::collision::scene::collision_scene::{CollisionScene, PairId};
use crate::collision::scene::pair_query::{Contact, exact_clearance, hull_clearance};
use crate::collision::scene::pair_set::PairSet;
use foliate_components::Pose;
use glam::DVec3;

/// Hulls that are this share of what an interval takes apart leave the pair to its halves; below it, the meshes themselves
/// are asked.
const HULL_SHARE: f64 = 0.05;

/// Meshes are asked for this many times more than what an interval takes: twice for each neighbour to one side.
const NEIGHBOURS: f64 = 4.0;

/// Hulls that overlapped so often in a row are asked again after as many samples that their triangles leave open.
const MOST_SPARED: u8 = 8;

/// What became of a pair in an interval.
pub(crate) enum Outcome {
    /// Free throughout, by at least this, metres.
    Certified(f64),
    Open,
    /// It collides, at the sample.
    Collides(Contact),
    /// It cannot be certified at the resolution.
    Doubtful(Contact),
}

/// What does not depend on the sample.
#[derive(Clone, Copy)]
pub(crate) struct NarrowPhase<'a> {
    pub scene: &'a CollisionScene,
    pub pairs: &'a PairSet,
    pub settings: &'a CertificateSettings,
}

/// A pair at a sample.
pub(crate) struct Here {
    /// Poses of the two bodies.
    pub X: [Pose; 2],
    /// How far the interval can bring the two closer, metres.
    pub closer: f64,
    /// Whether directions have a chance.
    pub is_fine: bool,
    /// Pairs that move by no more than this are in doubt, metres.
    pub resolution: f64,
}

/// Directions that set a pair apart before, zero where none is known.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hints {
    /// Its solids.
    pub solids: DVec3,
    /// Their hulls.
    pub hulls: DVec3,
    /// How often in a row the hulls overlapped where they were asked last, up to a few times.
    pub overlaps: u8,
    /// How often they need not be asked again after the triangles.
    pub spared: u8,
}

impl NarrowPhase<'_> {
    /// Tests a pair at a sample; also a direction along which the two are set apart there, zero where none is known.
    pub(crate) fn at(
        &self,
        id: PairId,
        sample: &Here,
        hints: &mut Hints,
        along: impl FnOnce(DVec3) -> f64,
    ) -> (Outcome, DVec3) {
        if self.scene.is_convex(id) {
            self.at_convex(id, sample, hints, along)
        } else {
            self.at_meshes(id, sample, hints, along)
        }
    }

    fn keep(&self, id: PairId) -> f64 {
        self.pairs.margins[id.at()] + self.settings.clearance_guard
    }

    fn at_convex(
        &self,
        id: PairId,
        here: &Here,
        hints: &mut Hints,
        along: impl FnOnce(DVec3) -> f64,
    ) -> (Outcome, DVec3) {
        let keep = self.keep(id);
        let needed = keep + here.closer;
        let query = if here.is_fine {
            DistanceQuery { relative: 0.05, ..DistanceQuery::exact(needed) }
        } else {
            // Where directions are no help, only a collision at the sample still matters.
            DistanceQuery { floor: keep, ..DistanceQuery::exact(needed) }
        };
        let found = exact_clearance(self.scene, id, here.X, query, &mut hints.solids);
        // The distance of convex solids is their gap along the hint.
        let n = hints.solids;
        (certified(found, keep, n, here, along).unwrap_or_else(|| self.undecided(id, found, keep, here)), n)
    }

    /// Where one is a mesh its hull is asked first, and where hulls are apart a direction is known. Hulls that overlapped
    /// nearby, as that of a hand and what it reaches around, are asked last.
    fn at_meshes(
        &self,
        id: PairId,
        here: &Here,
        hints: &mut Hints,
        along: impl FnOnce(DVec3) -> f64,
    ) -> (Outcome, DVec3) {
        if hints.overlaps > 0 {
            let outcome = self.by_triangles(id, here, hints);
            let decided = matches!(outcome, Outcome::Certified(_) | Outcome::Collides(_));
            if decided || hints.spared > 0 {
                hints.spared -= u8::from(!decided);
                return (outcome, DVec3::ZERO);
            }
            let (by_hulls, n) = self.by_hulls(id, here, hints, along);
            return (by_hulls.unwrap_or(outcome), n);
        }
        let (by_hulls, n) = self.by_hulls(id, here, hints, along);
        (by_hulls.unwrap_or_else(|| self.by_triangles(id, here, hints)), n)
    }

    /// What hulls say, if anything, and a direction that sets them apart, zero where none is known.
    fn by_hulls(
        &self,
        id: PairId,
        here: &Here,
        hints: &mut Hints,
        along: impl FnOnce(DVec3) -> f64,
    ) -> (Option<Outcome>, DVec3) {
        let keep = self.keep(id);
        let needed = keep + here.closer;
        let floor = if here.is_fine { needed } else { keep };
        let query = DistanceQuery { floor, relative: 0.05, ..DistanceQuery::exact(needed) };
        let apart = hull_clearance(self.scene, id, here.X, query, &mut hints.hulls);
        hints.overlaps = if apart > 0.0 { 0 } else { (hints.overlaps + 1).min(MOST_SPARED) };
        hints.spared = hints.overlaps;
        let n = if apart >= keep { hints.hulls } else { DVec3::ZERO };
        let certified = certified(apart, keep, n, here, along);
        let is_left_to_halves = apart - keep >= HULL_SHARE * here.closer && 2.0 * here.closer > here.resolution;
        (certified.or(is_left_to_halves.then_some(Outcome::Open)), n)
    }

    /// What the solids themselves say; what they keep may cover neighbours as well.
    fn by_triangles(&self, id: PairId, here: &Here, hints: &mut Hints) -> Outcome {
        let keep = self.keep(id);
        let needed = keep + here.closer;
        // Once the interval is open only a collision at the sample still matters.
        let query = DistanceQuery {
            needed: needed + NEIGHBOURS * here.closer,
            floor: needed,
            ground: keep,
            ..DistanceQuery::exact(needed)
        };
        let found = exact_clearance(self.scene, id, here.X, query, &mut hints.solids);
        if found >= needed {
            return Outcome::Certified(found - here.closer);
        }
        self.undecided(id, found, keep, here)
    }

    /// What becomes of a pair that is not certified.
    fn undecided(&self, pair: PairId, clearance: f64, keep: f64, here: &Here) -> Outcome {
        let contact = Contact { pair, clearance };
        // Compared so that NaN collides.
        let keeps = clearance >= keep;
        match (keeps, 2.0 * here.closer > here.resolution) {
            (false, _) => Outcome::Collides(contact),
            (true, true) => Outcome::Open,
            (true, false) => Outcome::Doubtful(contact),
        }
    }
}

/// What is certified over the interval by the clearance `found` at the sample: by how much closer the pair can come anyhow, or
/// by how much along the direction `n` (zero for none) in which `found` is the gap.
fn certified(found: f64, keep: f64, n: DVec3, here: &Here, along: impl FnOnce(DVec3) -> f64) -> Option<Outcome> {
    if found >= keep + here.closer {
        return Some(Outcome::Certified(found - here.closer));
    }
    if !here.is_fine || found < keep || n == DVec3::ZERO {
        return None;
    }
    let along = along(n);
    (found >= keep + along).then_some(Outcome::Certified(found - along))
}
