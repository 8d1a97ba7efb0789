//! The nearest node of each of many configurations: those asked of one region are looked for together.

use crate::exploration::neighbours::index::{ByTree, Neighbours};
use crate::planning_model::model::PlanningModel;
use crate::runtime::parallel::runs;
use foliate_components::graph::StateId;
use foliate_components::graph::leaf::LeafId;
use foliate_components::roadmap::{NodeId, Roadmap, TreeId};
use foliate_kernels::nearest::{BucketQueries, nearest};

/// Among which nodes the nearest is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Region {
    /// Those on a leaf; distances are those of the robots alone, since the attachments of objects are constant.
    Leaf(LeafId),
    /// Those in a state.
    State(StateId),
    /// Those of the whole roadmap.
    Roadmap,
}

/// Which node is nearest to a configuration.
#[derive(Clone, Debug)]
pub struct Question<'q> {
    /// Number of the query, for the caller: queries are reordered.
    pub asker: usize,
    /// Where to search.
    pub region: Region,
    /// Only in this tree, if any.
    pub tree: Option<TreeId>,
    /// The configuration.
    pub q: &'q [f64],
    /// The nearest node, ties by lowest id; `None` where there is none, and before the query has run.
    pub nearest: Option<NodeId>,
}

impl Region {
    fn nodes(self, roadmap: Roadmap<'_>) -> impl Iterator<Item = NodeId> {
        let (listed, all) = match self {
            Self::Leaf(leaf) => (roadmap.nodes_on(leaf), 0),
            Self::State(_) | Self::Roadmap => (&[][..], roadmap.nodes().len() as u32),
        };
        let lies_here = move |node: &NodeId| match self {
            Self::State(state) => roadmap.node(*node).state == state,
            Self::Leaf(_) | Self::Roadmap => true,
        };
        listed.iter().copied().chain((0..all).map(NodeId)).filter(lies_here)
    }
}

impl Neighbours {
    /// Finds the nearest node for every question. `tree_of` says in which tree a node lies by that in which it was born.
    /// Questions come back sorted by region, tree and asker.
    pub fn answer(
        &self,
        model: &PlanningModel,
        roadmap: Roadmap<'_>,
        questions: &mut [Question<'_>],
        tree_of: impl Fn(TreeId) -> TreeId + Sync,
    ) {
        let kind = |question: &Question<'_>| (question.region, question.tree);
        questions.sort_unstable_by_key(|question| (kind(question), question.asker));
        let buffers = <(BucketQueries, Vec<Option<(f64, u32)>>)>::default;
        runs(
            questions,
            |a, b| kind(a) == kind(b),
            buffers,
            |(queries, best), run| {
                let Some((region, tree)) = run.first().map(kind) else { return };
                let (metric, weights) = match region {
                    Region::Leaf(_) => (&self.robots, &model.robot_weights),
                    Region::State(_) | Region::Roadmap => (&self.everything, &model.weights),
                };
                let wanted = |born| tree.is_none_or(|tree| tree_of(born) == tree);
                let Some(crowd) = self.crowd(region) else {
                    return run.iter_mut().for_each(|question| {
                        let nodes = region.nodes(roadmap).filter(|&node| wanted(roadmap.node(node).tree));
                        question.nearest = model.nearest(roadmap, question.q, nodes, weights);
                    });
                };
                queries.set(metric, run.iter().map(|question| question.q));
                let of_trees = crowd.iter().flatten().filter(|(born, _)| wanted(*born)).map(|(_, bucket)| bucket);
                let space = &model.problem.robot.space;
                let distance =
                    |query: usize, id: u32| space.distance(run[query].q, roadmap.configuration(NodeId(id)), weights);
                nearest((metric, queries, self.level), of_trees, distance, best);
                run.iter_mut().zip(best).for_each(|(question, best)| question.nearest = best.map(|(_, id)| NodeId(id)));
            },
        );
    }

    /// The buckets of a region, where its nodes lie in lanes.
    fn crowd(&self, region: Region) -> Option<&[ByTree]> {
        match region {
            Region::Leaf(leaf) => self.leaves.get(&leaf).map(std::slice::from_ref),
            Region::State(state) => {
                self.states.as_ref().map(|states| states.get(state.at()..=state.at()).unwrap_or_default())
            }
            Region::Roadmap => self.states.as_deref(),
        }
    }
}
