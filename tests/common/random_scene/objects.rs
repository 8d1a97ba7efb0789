//! What is carried, opened, or carries others: blocks with handles of every mask, tables, drawers and doors.

use super::draw::{Draw, rounded};
use super::model::{Model, Motion, Place};
use super::shapes::{cuboid, within};
use std::f64::consts::FRAC_PI_2;

/// What a handle fixes and what it freezes, in its frame: x approaches, y is across the fingers.
pub const MASKS: [([u8; 6], [u8; 6]); 7] = [
    ([1, 1, 1, 1, 1, 1], [0, 0, 0, 0, 0, 0]),
    ([1, 1, 1, 1, 1, 1], [0, 0, 0, 0, 0, 0]),
    ([1, 1, 1, 0, 1, 1], [0, 0, 0, 1, 0, 0]),
    ([1, 1, 1, 0, 1, 1], [0, 0, 0, 0, 0, 0]),
    ([1, 1, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]),
    ([1, 1, 1, 0, 0, 0], [0, 0, 0, 0, 0, 0]),
    ([1, 1, 0, 1, 1, 1], [0, 0, 1, 0, 0, 0]),
];

/// An object, and the data that its placement needs.
#[derive(Clone, Debug)]
pub struct Block {
    pub model: Model,
    pub height: f64,
    /// Whether its handle lets it turn about the approach.
    pub turns: bool,
}

fn handle(name: &str, link: &str, place: Place, (mask, complement): ([u8; 6], [u8; 6]), clearance: f64) -> String {
    let ([x, y, z], [roll, pitch, yaw]) = (place.xyz, place.rpy);
    let row = |mask: [u8; 6]| mask.map(|m| m.to_string()).join(" ");
    format!(
        "<handle name=\"{name}\" clearance=\"{clearance}\"><position xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>\
         <link name=\"{link}\"/><mask>{}</mask><mask_complement>{}</mask_complement></handle>",
        row(mask),
        row(complement)
    )
}

/// A rectangle at that height, seen from above or from below.
fn contact(name: &str, link: &str, [x, y]: [f64; 2], z: f64, up: bool) -> String {
    let (x, y) = (x / 2.0, y / 2.0);
    let mut corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
    if !up {
        corners.reverse();
    }
    let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x} {y} {z}")).collect();
    let points = points.join(" ");
    format!("<contact name=\"{name}\"><link name=\"{link}\"/><point>{points}</point><shape>4 0 1 2 3</shape></contact>")
}

/// Something to be held between fingers so far apart; one that lies on tables has a handle on top and a face below.
pub fn block(draw: &mut Draw, name: &str, opening: f64, lies: bool) -> Block {
    let mut model = Model::new(name);
    let link = model.link("body");
    let width = rounded((opening - draw.range(0.006, 0.02)).max(0.012));
    let height = if lies { draw.range(0.04, 0.1) } else { draw.range(0.02, 0.06) };
    let geometry = within(draw, &mut model, [width, width, height]);
    model.shape(link, Place::default(), &geometry);
    let masks = draw.of(&MASKS);
    let mut place = Place::default();
    if lies {
        place = Place { xyz: [0.0, 0.0, rounded(height / 2.0 - 0.012)], rpy: [0.0, FRAC_PI_2, 0.0] };
    }
    let mut elements = vec![handle("grab", "body", place, masks, 0.05)];
    if lies {
        elements.push(contact("bottom", "body", [width, width], -height / 2.0, false));
        if draw.chance(0.3) {
            elements.push(contact("lid", "body", [width, width], height / 2.0, true));
        }
    } else if draw.chance(0.4) {
        let other = Place { xyz: [0.0; 3], rpy: [0.0, 0.0, FRAC_PI_2 * draw.sign()] };
        elements.push(handle("again", "body", other, draw.of(&MASKS), 0.04));
    }
    model.srdf = Some(elements);
    Block { model, height, turns: masks.0[3] == 0 && masks.1[3] == 0 }
}

/// A table whose top is at that height, with posts or a rim on it.
pub fn table(draw: &mut Draw, height: f64) -> Model {
    let mut model = Model::new("table");
    let top = model.link("top");
    let sides = [draw.range(0.7, 0.9), draw.range(0.7, 0.9)];
    let geometry = cuboid([sides[0], sides[1], 0.04]);
    model.shape(top, Place::at(0.0, 0.0, height - 0.02), &geometry);
    for number in 0..draw.index(4) {
        let place = Place::at(draw.range(-0.35, 0.35), draw.range(-0.35, 0.35), height);
        let link = model.joint(&format!("post{number}"), Motion::Fixed, top, place, [0.0, 0.0, 1.0]);
        let tall = draw.range(0.03, 0.25);
        let wide = draw.range(0.002, 0.05);
        let geometry = within(draw, &mut model, [wide, wide, tall]);
        model.shape(link, Place::at(0.0, 0.0, tall / 2.0), &geometry);
    }
    model.srdf = Some(vec![contact("plate", "top", sides, height, true)]);
    model
}

/// A drawer that slides, or a leaf that turns, with a knob to be taken from above. How far it opens at most.
pub fn furniture(draw: &mut Draw, height: f64) -> (Model, f64) {
    let mut model = Model::new("cabinet");
    let shell = model.link("shell");
    for (place, sides) in [
        (Place::at(0.15, 0.16, height / 2.0), [0.3, 0.02, height]),
        (Place::at(0.15, -0.16, height / 2.0), [0.3, 0.02, height]),
        (Place::at(0.31, 0.0, height / 2.0), [0.02, 0.34, height]),
    ] {
        model.shape(shell, place, &cuboid(sides));
    }
    let slides = draw.chance(0.6);
    let range = if slides { draw.range(0.1, 0.2) } else { draw.range(0.5, 1.2) };
    let tray = if slides {
        let tray = model.joint("drawer", Motion::Prismatic, shell, Place::default(), [-1.0, 0.0, 0.0]);
        model.shape(tray, Place::at(0.14, 0.0, height - 0.06), &cuboid([0.26, 0.26, 0.02]));
        model.shape(tray, Place::at(-0.012, 0.0, height - 0.04), &cuboid([0.02, 0.33, 0.08]));
        tray
    } else {
        let leaf = model.joint("door", Motion::Revolute, shell, Place::at(-0.015, -0.16, 0.0), [0.0, 0.0, 1.0]);
        model.shape(leaf, Place::at(0.0, 0.16, height / 2.0), &cuboid([0.02, 0.3, height]));
        leaf
    };
    model.last_joint().limits = (0.0, range);
    let (x, y) = if slides { (-0.05, draw.range(-0.1, 0.1)) } else { (-0.045, draw.range(0.2, 0.28)) };
    model.shape(tray, Place::at(x + 0.02, y, height - 0.02), &cuboid([0.05, 0.02, 0.02]));
    let geometry = within(draw, &mut model, [0.024, 0.024, 0.09]);
    model.shape(tray, Place::at(x, y, height + 0.015), &geometry);
    let place = Place { xyz: [x, y, height + 0.045], rpy: [0.0, FRAC_PI_2, 0.0] };
    let free = [([1, 1, 1, 0, 1, 1], [0; 6]), ([1, 1, 1, 0, 0, 0], [0; 6])];
    let masks = if slides && draw.chance(0.3) { draw.of(&MASKS) } else { draw.of(&free) };
    model.srdf = Some(vec![handle("knob", "tray_link", place, masks, 0.04)]);
    let link = model.links[tray].name.clone();
    model.srdf = model.srdf.map(|list| list.iter().map(|e| e.replace("tray_link", &link)).collect());
    (model, range)
}
