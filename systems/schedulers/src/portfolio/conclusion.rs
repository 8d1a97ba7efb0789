//! When a portfolio ends, which events its host gets, and which member answers.

use crate::portfolio::members::{MemberCounts, PortfolioMembers};
use bevy_ecs::prelude::{Res, ResMut, World};
use foliate_components::graph::leaf::LeafIndex;
use foliate_components::outcome::SearchOutcome;
use foliate_systems::events::{EventSink, SearchEvent, StopSignal};
use foliate_systems::exploration::roots::Ending;
use foliate_systems::schedule::StepCounter;
use foliate_systems::search::session::{AnswerIn, Search};
use foliate_systems::settings::SearchSettings;

/// Ends the portfolio when a member has solved the problem, when all together have spent a budget, when none of them continues,
/// or when the host or its clock stops it. Budgets are checked between rounds.
pub fn conclude(
    settings: Res<'_, SearchSettings>,
    stop: Res<'_, StopSignal>,
    portfolio_members: Res<'_, PortfolioMembers>,
    mut counter: ResMut<'_, StepCounter>,
    mut ending: ResMut<'_, Ending>,
) {
    *counter = portfolio_members.counts().iter().map(|count| count.counter).sum();
    let nodes: usize = portfolio_members.searches().map(|search| search.roadmap().nodes().len()).sum();
    let bytes: u64 = portfolio_members.searches().map(Search::bytes).sum();
    // A member that was stopped in the middle of a step might have been the one to answer.
    ending.0 = if let Some(stopped) = stop.outcome() {
        Some(stopped)
    } else if portfolio_members.winner().is_some() {
        Some(SearchOutcome::Solved)
    } else if nodes >= settings.max_nodes || bytes >= settings.max_bytes {
        Some(SearchOutcome::MemoryLimit)
    } else if settings.max_steps > 0 && counter.step >= settings.max_steps {
        Some(SearchOutcome::StepLimit)
    } else if portfolio_members.running.iter().all(|running| running.has_ended()) {
        portfolio_members.searches().next().and_then(|first| first.ending().cloned())
    } else {
        None
    };
}

/// Sends the host, where it listens, the events of the round, member by member, and their progress together. Rejected candidates are
/// those of all members, feedback is that of the one that would answer now.
pub fn report_progress(
    counter: Res<'_, StepCounter>,
    ending: Res<'_, Ending>,
    mut portfolio_members: ResMut<'_, PortfolioMembers>,
    mut events: ResMut<'_, EventSink>,
) {
    if !events.is_open() {
        return;
    }
    let leader = portfolio_members.leader();
    let mut progress = [0; 3];
    for (number, running) in portfolio_members.deciding().iter_mut().enumerate() {
        let is_told = |event: &SearchEvent| match event {
            SearchEvent::Rejected { .. } => true,
            SearchEvent::Feedback(_) => number == leader,
            // Progress and solution are those of all together.
            _ => false,
        };
        running.events.try_iter().map(|told| told.event).filter(is_told).for_each(|event| events.send(event));
        events.dropped += std::mem::take(&mut running.search.world_mut().resource_mut::<EventSink>().dropped);
        let (roadmap, leaves) = (running.search.roadmap(), running.search.world().resource::<LeafIndex>());
        let sizes = [roadmap.nodes().len(), roadmap.edges().len(), leaves.leaves().len()];
        progress.iter_mut().zip(sizes).for_each(|(sum, size)| *sum += size);
    }
    let (step, [nodes, edges, leaves]) = (counter.step, progress);
    events.send(SearchEvent::Progress { step, candidates: counter.candidates, nodes, edges, leaves });
    if ending.0 == Some(SearchOutcome::Solved) {
        events.send(SearchEvent::Solved { step });
    }
}

/// Once the portfolio has ended, hands over the world that answers: the winner's, or the first where there is none.
pub fn answer(world: &mut World) {
    let Some(ending) = world.resource::<Ending>().0.clone() else { return };
    let Some(mut portfolio_members) =
        world.remove_resource::<PortfolioMembers>().filter(|portfolio_members| !portfolio_members.running.is_empty())
    else {
        return;
    };
    let counts = portfolio_members.counts();
    let mut answer = portfolio_members.running.swap_remove(portfolio_members.leader()).search.into_world();
    answer.insert_resource(Ending(Some(ending)));
    answer.insert_resource(MemberCounts(counts));
    answer.insert_resource(std::mem::take(&mut *world.resource_mut::<EventSink>()));
    world.insert_resource(AnswerIn(Box::new(answer)));
}
