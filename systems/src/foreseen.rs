//! Motions that are likely to be proposed next, certified by threads that have nothing else to do.
//!
//! What a motion between two nodes is does not depend on when it is asked for, so an answer that is there already is the
//! answer. Which motions are foreseen, and how far a thread came with them, decides only who does the work.

use crate::connection::{Attempt, ConnectionScratch};
use crate::errands::Errands;
use crate::model::PlanningModel;
use crate::scratch_pool::ScratchPool;
use crate::settings::SearchSettings;
use bevy_ecs::prelude::Resource;
use foliate_components::leaf::LeafIndex;
use foliate_components::roadmap::{Motion, NodeId, Roadmap};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// See the module.
#[derive(Default, Resource)]
pub struct Foreseen {
    prospects: Vec<(NodeId, NodeId, Arc<Prospect>)>,
    buffers: Arc<ScratchPool<ConnectionScratch>>,
}

/// A motion that may be asked for.
pub(crate) struct Prospect {
    attempt: Attempt,
    model: PlanningModel,
    settings: SearchSettings,
    /// Whether somebody has begun.
    is_taken: AtomicBool,
    /// Whether who had begun has given up.
    is_lost: AtomicBool,
    answer: OnceLock<Option<Motion>>,
}

/// Gives a prospect up where nothing came of it.
struct Taken<'a>(&'a Prospect);

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        self.0.is_lost.store(self.0.answer.get().is_none(), Ordering::Release);
    }
}

impl Prospect {
    /// Certifies it, unless somebody has begun to.
    fn certify_ahead(&self, buffers: &ScratchPool<ConnectionScratch>) {
        if !self.is_taken.swap(true, Ordering::AcqRel) {
            self.certify_now(&mut buffers.borrow());
        }
    }

    fn certify_now(&self, scratch: &mut ConnectionScratch) -> Option<Motion> {
        let _given_up_in_a_panic = Taken(self);
        let answer = self.attempt.certify(&self.model, &self.settings, scratch);
        self.answer.get_or_init(|| answer).clone()
    }

    /// Whether another thread is at it.
    pub(crate) fn is_under_way(&self) -> bool {
        self.is_taken.load(Ordering::Acquire) && self.answer.get().is_none()
    }

    /// The certified motion, whole or not at all: that of the thread that has begun, else by this one.
    pub(crate) fn certify(&self, scratch: &mut ConnectionScratch) -> Option<Motion> {
        while self.is_taken.swap(true, Ordering::AcqRel) && !self.is_lost.load(Ordering::Acquire) {
            match self.answer.get() {
                Some(answer) => return answer.clone(),
                None => std::thread::yield_now(),
            }
        }
        self.certify_now(scratch)
    }
}

impl Foreseen {
    /// Leaves the motions between these nodes to be certified, most likely first, for whoever has nothing else to do. What was
    /// foreseen before is kept where it is foreseen again or asked for now.
    pub fn expect(
        &mut self,
        (model, settings, errands): (&PlanningModel, &SearchSettings, &Errands),
        (roadmap, leaves): (&Roadmap, &LeafIndex),
        next: &[(NodeId, NodeId)],
        asked: &[(NodeId, NodeId)],
    ) {
        self.prospects.retain(|&(from, to, _)| next.contains(&(from, to)) || asked.contains(&(from, to)));
        // A lazy graph grows in place as long as nobody else holds the model.
        if !errands.are_done() || model.graph.lazy {
            return;
        }
        for &(from, to) in next {
            if self.of(from, to).is_none()
                && let Some(attempt) = Attempt::new(model, roadmap, leaves, (from, to))
            {
                let prospect = Prospect {
                    attempt,
                    model: model.clone(),
                    settings: settings.clone(),
                    is_taken: AtomicBool::new(false),
                    is_lost: AtomicBool::new(false),
                    answer: OnceLock::new(),
                };
                self.prospects.push((from, to, Arc::new(prospect)));
            }
        }
    }

    /// Lets threads that have nothing else to do begin with what is foreseen.
    pub(crate) fn release(&self, errands: &Errands) {
        let errand = |(_, _, prospect): &(NodeId, NodeId, Arc<Prospect>)| {
            let (prospect, buffers) = (Arc::clone(prospect), Arc::clone(&self.buffers));
            Box::new(move || prospect.certify_ahead(&buffers)) as Box<dyn FnOnce() + Send>
        };
        let open = |(_, _, prospect): &&(NodeId, NodeId, Arc<Prospect>)| !prospect.is_taken.load(Ordering::Relaxed);
        errands.replace(self.prospects.iter().filter(open).map(errand));
    }

    /// What was foreseen between two nodes.
    pub(crate) fn of(&self, from: NodeId, to: NodeId) -> Option<&Prospect> {
        self.prospects.iter().find(|&&(a, b, _)| (a, b) == (from, to)).map(|(_, _, prospect)| &**prospect)
    }
}
