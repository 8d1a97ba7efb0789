//! Which pairs of shapes are left out, by name.

use crate::collision::scene::collision_scene::CollisionScene;
use crate::collision::scene::pair_filter::{PairRule, Rules};
use crate::collision::scene::pair_query::{body_pose, touch};
use foliate_components::Pose;
use foliate_components::coverage::LeftOutPair;
use foliate_components::robot::{Robot, ShapeIndex};

impl CollisionScene {
    /// All pairs of shapes that are not tested, with the reason: what [`Self::counts`] counts. `robot` and `rule` are those that the
    /// scene was made of.
    #[must_use]
    pub fn left_out(&self, robot: &Robot, rule: &PairRule<'_>) -> Vec<LeftOutPair> {
        let rules = Rules::new(robot, rule);
        let mut pairs = Vec::new();
        for (first, one) in self.solids.iter().enumerate() {
            for (second, other) in self.solids.iter().enumerate().skip(first + 1) {
                if let Some(why) = rules.left_out(one.link, other.link) {
                    let (first, second) = (ShapeIndex(first as u32), ShapeIndex(second as u32));
                    pairs.push(LeftOutPair { first, second, why });
                }
            }
        }
        pairs
    }

    /// Whether two shapes touch where the bodies are at `X_WJ` (to within a micrometre), or one lies inside the other.
    ///
    /// # Panics
    /// If a shape is not the scene's, or `X_WJ` is shorter than the number of bodies.
    #[must_use]
    pub fn touch(&self, first: ShapeIndex, second: ShapeIndex, X_WJ: &[Pose]) -> bool {
        let (a, b) = (&self.solids[first.at()], &self.solids[second.at()]);
        touch(a, &body_pose(a, X_WJ), b, &body_pose(b, X_WJ))
    }
}
