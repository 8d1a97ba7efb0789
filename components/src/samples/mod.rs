//! Small problems for tests, benches and examples, made of boxes and simple arms. No files are read.

pub(crate) mod articulated;
pub mod boxes;
pub(crate) mod crowds;
pub mod models;
pub mod rearrangements;
pub(crate) mod stacks;
pub(crate) mod stances;

pub use crate::samples::articulated::{open_a_box_and_move_it, open_a_drawer, open_a_drawer_with_a_box_in_it};
pub use crate::samples::boxes::{boxes_on_a_table, move_one_box, swap_two_boxes, swap_with_crossed_foliations};
pub use crate::samples::crowds::{crowd, eight_arms_and_ten_boxes};
pub use crate::samples::rearrangements::rearrange_boxes;
pub use crate::samples::stacks::{carry_a_box_with_its_lid, hold_a_lid_by_a_magnet, put_a_lid_on_a_box};
pub use crate::samples::stances::{make_a_step, move_one_box_with_a_level_hand};
