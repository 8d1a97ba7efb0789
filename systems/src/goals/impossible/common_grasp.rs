//! Whether an object has a grasp by which it can be moved from where it starts to where goals have it, by way of places where it can be put
//! down and taken by another grasp.
//!
//! Where there is none, two leaves that a path would have to join have none in common. It is evidence and no proof: as many places as are
//! drawn.

use crate::events::StopSignal;
use crate::goals::impossible::moves::{moves_in_hands_alone, own_grasps};
use crate::goals::impossible::site::Site;
use crate::goals::impossible::survey::Survey;
use crate::planning_model::model::{Model, PlanningModel};
use crate::settings::SearchSettings;
use foliate_components::robot::{GripperIndex, HandleIndex};
use std::fmt;

/// Places that are looked at for each grasp, draws for them, and tries of each other grasp there.
const PLACES: u32 = 128;
const DRAWS: u32 = 1024;
const PLACE_TRIES: u32 = 64;
/// Where fewer places were found, and any at all, nothing is said.
const ENOUGH_PLACES: u32 = 64;
/// Tries of each grasp before others are tried more often.
const FEW_TRIES: u32 = 16;
/// Of objects with more grasps nothing is said.
const MOST_GRASPS: usize = 16;
/// Grasps that a message names on each side.
const MOST_NAMED: usize = 3;

/// An object that can be held where it starts and where goals have it, and by no grasp at both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoCommonGrasp {
    /// Grasps that are possible where it starts: `gripper at handle`.
    pub start: Vec<String>,
    /// Grasps that are possible where goals have it.
    pub goal: Vec<String>,
    /// Places at which it could be put down with a grasp of the start, and that were tried for a change of grasp.
    pub places: u32,
}

impl fmt::Display for NoCommonGrasp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = |grasps: &[String]| match grasps.len().checked_sub(MOST_NAMED) {
            Some(more) if more > 0 => format!("{} and {more} grasps more", grasps[..MOST_NAMED].join(", ")),
            _ => grasps.join(", "),
        };
        let (start, goal) = (named(&self.start), named(&self.goal));
        write!(f, "where it starts only {start} is possible, where the goal has it only {goal}, ")?;
        match self.places {
            0 => f.write_str("and no place was found where it could be put down between"),
            places => write!(f, "and at none of {places} places between was a change of grasp possible"),
        }
    }
}

/// What keeps an object from being moved although it can be held at both ends. `None` where a grasp takes it there, also by way of places
/// between; where it may be handed over, moves on other objects or stays in the air; and where the stop signal is raised.
#[must_use]
pub fn no_common_grasp(
    model: &PlanningModel,
    (settings, stop): (&SearchSettings, &StopSignal),
    start: &[f64],
    object: usize,
) -> Option<NoCommonGrasp> {
    let graph = &model.graph;
    let is_handed_over = graph.states.iter().any(|state| own_grasps(graph, state, object).count() > 1);
    let is_simple = !graph.lazy && !is_handed_over && moves_in_hands_alone(graph, object);
    let resting = model.objects()[object].resting.iter().find(|place| place.on.is_none()).filter(|_| is_simple)?;
    let at_start = Site::at_start(model, start, object)?;
    let goals = Site::at_goals(model, start, object)?;
    let mut survey = Survey::new(model, settings, stop, &at_start, object)?;
    let ends = goals.iter().map(|site| Survey::new(model, settings, stop, site, object));
    let mut ends: Vec<Survey<'_>> = ends.collect::<Option<_>>()?;
    let count = survey.grasps.len();
    if count > MOST_GRASPS {
        return None;
    }
    // Nearly always some grasp serves at both ends: a few tries find it.
    let mut is_common = |grasp| {
        survey.attempt(grasp, FEW_TRIES, u64::MAX) && ends.iter_mut().any(|end| end.attempt(grasp, FEW_TRIES, u64::MAX))
    };
    if (0..count).any(&mut is_common) {
        return None;
    }
    let reached = survey.possible();
    let mut wanted = vec![false; count];
    for end in &mut ends {
        wanted.iter_mut().zip(end.possible()).for_each(|(wanted, possible)| *wanted |= possible);
    }
    let are_joined = |reached: &[bool]| reached.iter().zip(&wanted).any(|(reached, wanted)| *reached && *wanted);
    if !reached.contains(&true) || !wanted.contains(&true) || are_joined(&reached) {
        return None;
    }
    let names = |which: &[bool]| -> Vec<String> {
        let grasps = survey.grasps.iter().zip(which).filter(|(_, is_in)| **is_in);
        grasps.map(|(tries, _)| name(model, tries.grasp)).collect()
    };
    let (start, goal) = (names(&reached), names(&wanted));
    let anywhere = Site::lying(&at_start.q, resting.resting.constraint(0.0));
    let between = Survey::new(model, settings, stop, &anywhere, object)?;
    let places = places_without_a_change(between, reached, are_joined)?;
    (places == 0 || places >= ENOUGH_PLACES).then_some(NoCommonGrasp { start, goal, places })
}

/// Draws places where an object can be put down with one of the grasps that are `reached`, and looks there for others, which are reached then
/// too. The number of places; `None` where the ends are joined by what is reached, and where the stop signal is raised.
fn places_without_a_change(
    mut between: Survey<'_>,
    mut reached: Vec<bool>,
    are_joined: impl Fn(&[bool]) -> bool,
) -> Option<u32> {
    let mut all = 0;
    // Grasps whose places have not been looked at yet; each may bring others.
    let mut left: Vec<usize> = (0..reached.len()).filter(|&grasp| reached[grasp]).collect();
    while let Some(grasp) = left.pop() {
        let mut places = 0;
        for number in 0..DRAWS {
            if places == PLACES {
                break;
            }
            if between.is_stopped() {
                return None;
            }
            let Some(q) = between.draw(grasp, number) else { continue };
            places += 1;
            let site = between.where_it_is(&q)?;
            let mut there = between.elsewhere(&site)?;
            for (other, is_reached) in reached.iter_mut().enumerate() {
                if !*is_reached && there.attempt(other, PLACE_TRIES, u64::MAX) {
                    *is_reached = true;
                    left.push(other);
                }
            }
            if are_joined(&reached) {
                return None;
            }
        }
        all += places;
    }
    Some(all)
}

fn name(model: &Model, (gripper, handle): (GripperIndex, HandleIndex)) -> String {
    let robot = &model.problem.robot;
    format!("{} at {}", robot.grippers[gripper.at()].name, robot.handles[handle.at()].name)
}
