//! Goals that leave something free: configurations for them are drawn, at the start and again during the search.
//!
//! For every state of the graph one program says what holds in a goal of that state: the constraints of the state, the requirements of
//! the goal, and that objects which neither moves stay where the start has them. A held object whose pose the goal leaves
//! free is eliminated and follows the hand; one whose pose the goal names makes the hand follow. A state whose program
//! contradicts itself whatever the free joints do (the object is on the table, the goal has it in the air) is never
//! tried again. The others are tried in turn, from random configurations. In a lazy graph these are the start's state, then
//! its neighbours, then theirs, breadth first, as long as nothing is found.
//!
//! `demands` says which states fit a goal (nothing is left in a hand that was not asked for) and what is asked besides rows of
//! constraints; `overlaps` finds objects that a goal has in each other; `impossible` proves that no goal can be reached, or says why it likely cannot. `programs` compiles the program of one goal in one state; `region` draws configurations of one goal with it; `sampler`
//! holds the regions of all goals; `systems` makes what it draws roots of trees.

pub(crate) mod demands;
pub mod impossible;
pub(crate) mod overlaps;
pub(crate) mod programs;
pub(crate) mod region;
pub mod sampler;
pub mod systems;

pub use crate::goals::impossible::moves::objects_to_move;
pub use crate::goals::sampler::GoalSampler;
pub use crate::goals::systems::draw_more_goals;
