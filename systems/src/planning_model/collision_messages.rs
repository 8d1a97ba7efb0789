//! What collides at a start or goal, in words: every pair, and how to leave out those that may touch.

use crate::planning_model::model::Model;
use foliate_components::graph::StateId;
use foliate_components::robot::ShapeIndex;
use foliate_kernels::collision::Contact;

/// Most pairs that a message names.
const MOST: usize = 60;

/// The message.
pub(crate) fn tell(model: &Model, state: StateId, contacts: &[Contact]) -> String {
    let tell = |contact: &Contact| {
        let how = in_words(contact.clearance, model.margin_in(state, contact.pair));
        format!("{} collide ({how})", model.pair_name(contact.pair))
    };
    let shown: Vec<String> = contacts.iter().take(MOST).map(tell).collect();
    let more = contacts.len().saturating_sub(MOST);
    let more = if more > 0 { format!("; and {more} pairs more") } else { String::new() };
    format!("{}{more}; {}", shown.join("; "), way_out(model, contacts))
}

/// How to leave the pairs out: in the words of a scene file.
fn way_out(model: &Model, contacts: &[Contact]) -> String {
    let robot = &model.problem.robot;
    let link = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].name.as_str();
    let mut pairs: Vec<String> = Vec::new();
    for contact in contacts {
        let (a, b) = model.pair_shapes(contact.pair);
        let pair = format!("[\"{}\", \"{}\"]", link(a), link(b));
        if !pairs.contains(&pair) && pairs.len() < MOST {
            pairs.push(pair);
        }
    }
    format!("if they may touch, the scene can leave them out: ignore = [{}]", pairs.join(", "))
}

fn in_words(clearance: f64, margin: f64) -> String {
    // Closer than distances are exact, metres.
    const TOUCHING: f64 = 1e-6;
    if clearance == f64::NEG_INFINITY {
        "one lies inside the other".into()
    } else if clearance < -TOUCHING {
        format!("{:.2} mm deep", -clearance * 1e3)
    } else if clearance <= TOUCHING {
        "they touch or overlap".into()
    } else if margin > 0.0 {
        format!("{:.2} mm apart instead of {:.2} mm", clearance * 1e3, margin * 1e3)
    } else {
        format!("{:.4} mm apart", clearance * 1e3)
    }
}
