//! Motions that are likely to be proposed next, certified by threads that have nothing else to do.
//!
//! What a motion between two nodes is does not depend on when it is asked for, so an answer that is there already is the
//! answer. Which motions are predicted, and how far a thread came with them, decides only who does the work.

use crate::exploration::edges::{UnvalidatedEdges, Verdict};
use crate::planning_model::model::PlanningModel;
use crate::runtime::idle_tasks::IdleTasks;
use crate::runtime::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use crate::step::connection::attempt::{Attempt, ConnectionScratch};
use bevy_ecs::prelude::Resource;
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::roadmap::{NodeId, Roadmap};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// See the module.
#[derive(Default, Resource)]
pub struct SpeculativeChecks {
    speculations: Vec<(NodeId, NodeId, Arc<SpeculativeCheck>)>,
    buffers: Arc<ScratchPool<ConnectionScratch>>,
}

/// A motion that may be asked for.
pub(crate) struct SpeculativeCheck {
    attempt: Attempt,
    model: PlanningModel,
    settings: SearchSettings,
    /// Whether somebody has begun.
    is_taken: AtomicBool,
    /// Whether who had begun has given up.
    is_lost: AtomicBool,
    answer: OnceLock<Verdict>,
}

/// Gives a prospect up where nothing came of it.
struct Taken<'a>(&'a SpeculativeCheck);

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        self.0.is_lost.store(self.0.answer.get().is_none(), Ordering::Release);
    }
}

impl SpeculativeCheck {
    /// Certifies it, unless somebody has begun to.
    fn certify_ahead(&self, buffers: &ScratchPool<ConnectionScratch>) {
        if !self.is_taken.swap(true, Ordering::AcqRel) {
            // The answer stays where it is until somebody asks.
            let _ = self.certify_now(&mut buffers.borrow());
        }
    }

    fn certify_now(&self, scratch: &mut ConnectionScratch) -> Verdict {
        let _given_up_in_a_panic = Taken(self);
        let answer = self.attempt.certify(&self.model, &self.settings, scratch);
        self.answer.get_or_init(|| answer).clone()
    }

    /// Whether another thread is at it.
    pub(crate) fn is_under_way(&self) -> bool {
        self.is_taken.load(Ordering::Acquire) && self.answer.get().is_none()
    }

    /// The certified motions, whole or not at all: those of the thread that has begun, else by this one.
    pub(crate) fn certify(&self, scratch: &mut ConnectionScratch) -> Verdict {
        while self.is_taken.swap(true, Ordering::AcqRel) && !self.is_lost.load(Ordering::Acquire) {
            match self.answer.get() {
                Some(answer) => return answer.clone(),
                None => std::thread::yield_now(),
            }
        }
        self.certify_now(scratch)
    }
}

impl SpeculativeChecks {
    /// Leaves the motions between these nodes to be certified, most likely first, for whoever has nothing else to do. What was
    /// predicted before is kept where it is predicted again or asked for now.
    pub fn expect(
        &mut self,
        (model, settings, idle_tasks): (&PlanningModel, &SearchSettings, &IdleTasks),
        known: (Roadmap<'_>, &LeafIndex, &UnvalidatedEdges<'_, '_>),
        next: &[(NodeId, NodeId)],
        asked: &[(NodeId, NodeId)],
    ) {
        self.speculations.retain(|&(from, to, _)| next.contains(&(from, to)) || asked.contains(&(from, to)));
        // A lazy graph grows in place as long as nobody else holds the model.
        if !idle_tasks.are_done() || model.graph.lazy {
            return;
        }
        for &(from, to) in next {
            if self.of(from, to).is_none()
                && let Some(attempt) = Attempt::new(model, known, (from, to))
            {
                let speculation = SpeculativeCheck {
                    attempt,
                    model: model.clone(),
                    settings: settings.clone(),
                    is_taken: AtomicBool::new(false),
                    is_lost: AtomicBool::new(false),
                    answer: OnceLock::new(),
                };
                self.speculations.push((from, to, Arc::new(speculation)));
            }
        }
    }

    /// Lets threads that have nothing else to do begin with what is predicted.
    pub(crate) fn release(&self, idle_tasks: &IdleTasks) {
        let idle_task = |(_, _, speculation): &(NodeId, NodeId, Arc<SpeculativeCheck>)| {
            let (speculation, buffers) = (Arc::clone(speculation), Arc::clone(&self.buffers));
            Box::new(move || speculation.certify_ahead(&buffers)) as Box<dyn FnOnce() + Send>
        };
        let open = |(_, _, speculation): &&(NodeId, NodeId, Arc<SpeculativeCheck>)| {
            !speculation.is_taken.load(Ordering::Relaxed)
        };
        idle_tasks.replace(self.speculations.iter().filter(open).map(idle_task));
    }

    /// What was predicted between two nodes.
    pub(crate) fn of(&self, from: NodeId, to: NodeId) -> Option<&SpeculativeCheck> {
        self.speculations.iter().find(|&&(a, b, _)| (a, b) == (from, to)).map(|(_, _, speculation)| &**speculation)
    }
}

#[cfg(test)]
mod tests {
    use super::{Ordering, SpeculativeChecks};
    use crate::events::{EventSink, StopSignal};
    use crate::exploration::edges::UnvalidatedEdges;
    use crate::planning_model::model::{Model, PlanningModel};
    use crate::runtime::idle_tasks::IdleTasks;
    use crate::schedulers::mrrt::Mrrt;
    use crate::search::session::Search;
    use crate::settings::SearchSettings;
    use crate::step::connection::attempt::{Attempt, ConnectionScratch};
    use foliate_components::graph::leaf::LeafIndex;
    use foliate_components::roadmap::NodeId;
    use foliate_components::samples::boxes_on_a_table;
    use std::sync::Arc;

    #[test]
    fn what_was_foreseen_is_what_is_certified_when_it_is_asked_for() {
        // Out of the arm's reach, so that the search goes on.
        let problem = boxes_on_a_table(&[(0.6, 0.1)], &[(1.45, 0.75)]).ok();
        let model = problem.and_then(|problem| Model::new(problem).ok());
        assert!(model.is_some());
        let Some(model) = model else { return };
        let model = PlanningModel(Arc::new(model));
        let settings = SearchSettings::default();
        let mut search = Search::new(&model, &Mrrt, settings.clone(), StopSignal::default(), EventSink::default());
        (0..4).for_each(|_| assert!(search.step().is_none()));
        let mut unvalidated = bevy_ecs::system::SystemState::<UnvalidatedEdges<'_, '_>>::new(search.world_mut());
        let (roadmap, leaves) = (search.roadmap(), search.world().resource::<LeafIndex>());
        let on = |node: NodeId| roadmap.nodes_on(roadmap.node(node).leaf);
        let nodes = || (0..roadmap.nodes().len() as u32).map(NodeId);
        let pairs: Vec<_> = nodes().flat_map(|a| on(a).iter().map(move |&b| (a, b))).filter(|(a, b)| a < b).collect();
        let Ok(unvalidated_edges) = unvalidated.get(search.world()) else { return };
        let known = (roadmap, leaves, &unvalidated_edges);
        let mut scratch = ConnectionScratch::default();
        let mut direct = |ends| Attempt::new(&model, known, ends).map(|it| it.certify(&model, &settings, &mut scratch));
        let answers: Vec<_> = pairs.iter().filter_map(|&ends| direct(ends)).collect();
        assert_eq!(answers.len(), pairs.len());
        assert!(answers.iter().any(Result::is_ok) && answers.iter().any(Result::is_err), "{} pairs", pairs.len());

        let (mut speculative_checks, idle_tasks) = (SpeculativeChecks::default(), IdleTasks::default());
        speculative_checks.expect((&model, &settings, &idle_tasks), known, &pairs, &[]);
        assert!(speculative_checks.speculations.is_empty(), "nobody would do it");
        idle_tasks.pretend();
        speculative_checks.expect((&model, &settings, &idle_tasks), known, &pairs, &[]);
        speculative_checks.release(&idle_tasks);
        // One after the other: done ahead, not begun, begun by somebody who gave up.
        let done = pairs.len().div_ceil(3);
        (0..done).for_each(|_| assert!(idle_tasks.do_one()));
        for (number, (&(from, to), answer)) in pairs.iter().zip(&answers).enumerate() {
            let speculation = speculative_checks.of(from, to);
            assert!(speculation.is_some());
            let Some(speculation) = speculation else { return };
            assert_eq!(speculation.answer.get().is_some(), number < done);
            if number >= done && number % 2 == 0 {
                speculation.is_taken.store(true, Ordering::Relaxed);
                speculation.is_lost.store(true, Ordering::Relaxed);
            }
            assert_eq!(&speculation.certify(&mut scratch), answer);
            assert_eq!(&speculation.certify(&mut scratch), answer, "asked for twice");
        }
        // What has been asked for is not begun again, and what is neither predicted nor asked for any more is forgotten.
        assert!(idle_tasks.do_one());
        speculative_checks.expect((&model, &settings, &idle_tasks), known, &pairs[..2], &pairs[1..3]);
        assert_eq!(speculative_checks.speculations.len(), 3.min(pairs.len()));
    }
}
