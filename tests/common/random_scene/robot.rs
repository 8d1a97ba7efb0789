//! Random robots: arms, gantries, two arms on a torso, on bases that stand or move, with hands or without.

use super::draw::Draw;
use super::model::{Model, Motion, Place};
use super::shapes::{cuboid, within};
use std::f64::consts::{FRAC_PI_2, PI};

/// How a robot's root moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    Fixed,
    Planar,
    FreeFlyer,
}

/// A gripper's frame, and how wide its fingers are open.
#[derive(Clone, Debug)]
pub struct Hand {
    pub gripper: String,
    pub link: usize,
    pub place: Place,
    /// Between the fingers, metres.
    pub opening: f64,
    /// The joint that opens the fingers, and where it stands.
    pub leader: Option<(String, f64)>,
}

/// A robot with its hands.
#[derive(Clone, Debug)]
pub struct Robot {
    pub model: Model,
    pub root: Root,
    pub hands: Vec<Hand>,
    /// Last links of its limbs.
    pub tips: Vec<usize>,
}

impl Robot {
    /// An arm, a torso with two arms, or a gantry, on any base, without hands.
    pub fn any(draw: &mut Draw) -> Self {
        let root = draw.of(&[Root::Fixed, Root::Fixed, Root::Fixed, Root::Planar, Root::FreeFlyer]);
        let mut robot = Self::on_a_base(draw, root);
        match draw.index(4) {
            0 => {
                let tip = gantry(draw, &mut robot.model);
                robot.tips.push(tip);
            }
            1 => {
                for (side, y) in [("left", 0.22), ("right", -0.22)] {
                    let joints = 2 + draw.index(3);
                    let place = Place { xyz: [0.0, y, 0.3], rpy: [-y.signum() * 0.8, 0.0, 0.0] };
                    let tip = arm(draw, &mut robot.model, side, place, joints);
                    robot.tips.push(tip);
                }
            }
            _ => {
                let joints = 2 + draw.index(6);
                let tip = arm(draw, &mut robot.model, "arm", Place::at(0.0, 0.0, 0.2), joints);
                robot.tips.push(tip);
            }
        }
        if draw.chance(0.25) {
            let tip = robot.tips[0];
            robot.add_hand(draw, tip, "hand");
        }
        robot.describe(draw);
        robot
    }

    /// An arm of five to seven joints with a hand, or two of them.
    pub fn with_hands(draw: &mut Draw) -> Self {
        let mut robot = Self::on_a_base(draw, Root::Fixed);
        let sides: &[(&str, f64)] =
            if draw.chance(0.3) { &[("left", 0.25), ("right", -0.25)] } else { &[("arm", 0.0)] };
        for &(side, y) in sides {
            let joints = 5 + draw.index(3);
            let tip = arm(draw, &mut robot.model, side, Place::at(0.0, y, 0.2), joints);
            robot.tips.push(tip);
            robot.add_hand(draw, tip, side);
        }
        robot.describe(draw);
        robot
    }

    /// A hand that hangs from a gantry above everything.
    pub fn from_above(draw: &mut Draw) -> Self {
        let mut model = Model { capsules: draw.chance(0.3), ..Model::new("robot") };
        model.link("base");
        let tip = gantry(draw, &mut model);
        let mut robot = Self { model, root: Root::Fixed, hands: Vec::new(), tips: vec![tip] };
        robot.add_hand(draw, tip, "hand");
        robot.describe(draw);
        robot
    }

    fn on_a_base(draw: &mut Draw, root: Root) -> Self {
        let mut model = Model { capsules: draw.chance(0.3), ..Model::new("robot") };
        let base = model.link("base");
        if draw.chance(0.8) {
            let sides = [draw.range(0.1, 0.3), draw.range(0.1, 0.3), draw.range(0.1, 0.24)];
            let geometry = within(draw, &mut model, sides);
            model.shape(base, Place::at(0.0, 0.0, 0.06), &geometry);
        }
        if draw.chance(0.3) {
            // Something that is fixed to the base, beside it or far from it.
            let place = Place::at(draw.range(-0.5, 0.5), draw.range(0.2, 0.6) * draw.sign(), draw.range(0.0, 0.5));
            let post = model.joint("mount", Motion::Fixed, base, place, [0.0, 0.0, 1.0]);
            let geometry = within(draw, &mut model, [0.05, 0.08, 0.3]);
            model.shape(post, Place::default(), &geometry);
        }
        Self { model, root, hands: Vec::new(), tips: Vec::new() }
    }

    /// A palm whose fingers stand, move one by one, or follow one another.
    fn add_hand(&mut self, draw: &mut Draw, tip: usize, name: &str) {
        let model = &mut self.model;
        model.shape(tip, Place::at(0.0, 0.0, 0.015), &cuboid([0.03, 0.12, 0.03]));
        let finger = cuboid([0.02, 0.012, 0.07]);
        let z = 0.07;
        let (opening, leader) = match draw.index(4) {
            0 => {
                model.shape(tip, Place::at(0.0, 0.046, z), &finger);
                model.shape(tip, Place::at(0.0, -0.046, z), &finger);
                (0.08, None)
            }
            1 => (0.08, None),
            _ => {
                let leader = format!("{name}_finger");
                let link = model.joint(&leader, Motion::Prismatic, tip, Place::default(), [0.0, 1.0, 0.0]);
                model.last_joint().limits = (0.0, 0.05);
                model.shape(link, Place::at(0.0, 0.006, z), &finger);
                let mirror = format!("{name}_mirror");
                let (factor, offset, limits) = follower(draw);
                let axis = [0.0, -factor.signum(), 0.0];
                let link = model.joint(&mirror, Motion::Prismatic, tip, Place::default(), axis);
                let joint = model.last_joint();
                (joint.limits, joint.mimic) = (limits, Some((leader.clone(), factor, offset)));
                model.shape(link, Place::at(0.0, -0.006, z), &finger);
                let reach = |limit: f64| (limit - offset) / factor;
                let most = reach(limits.0).max(reach(limits.1)).min(0.05);
                let value = super::draw::rounded((most - 0.001).max(0.0));
                (2.0 * value.min(factor.abs() * value + offset * factor.signum()), Some((leader, value)))
            }
        };
        let place = Place { xyz: [0.0, 0.0, 0.09], rpy: [0.0, -FRAC_PI_2, 0.0] };
        self.hands.push(Hand { gripper: format!("{name}_grip"), link: tip, place, opening, leader });
    }

    /// With an SRDF or without; one names the hands, and perhaps the pairs that are not tested.
    fn describe(&mut self, draw: &mut Draw) {
        let mut elements = Vec::new();
        for hand in &self.hands {
            let ([x, y, z], [roll, pitch, yaw]) = (hand.place.xyz, hand.place.rpy);
            let (name, link) = (&hand.gripper, &self.model.links[hand.link].name);
            elements.push(format!(
                "<gripper name=\"{name}\" clearance=\"0.03\"><position xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>\
                 <link name=\"{link}\"/></gripper>"
            ));
        }
        let disables = draw.chance(0.5);
        if disables {
            for joint in &self.model.joints {
                let name = |link: usize| &self.model.links[link].name;
                elements.push(disabled(name(joint.parent), name(joint.child)));
                // What a fixed link without shapes separates is next to each other all the same.
                for next in self.model.joints.iter().filter(|next| next.parent == joint.child) {
                    elements.push(disabled(name(joint.parent), name(next.child)));
                }
            }
        }
        if disables || !self.hands.is_empty() {
            self.model.srdf = Some(elements);
        }
    }

    /// Whether its SRDF says which pairs are not tested.
    pub fn disables(&self) -> bool {
        self.model.srdf.iter().flatten().any(|element| element.starts_with("<disable"))
    }
}

fn disabled(one: &str, other: &str) -> String {
    format!("<disable_collisions link1=\"{one}\" link2=\"{other}\" reason=\"Adjacent\"/>")
}

/// Multiplier, offset and limits of a finger that follows another one with the range 0 … 0.05.
fn follower(draw: &mut Draw) -> (f64, f64, (f64, f64)) {
    draw.of(&[
        (1.0, 0.0, (0.0, 0.05)),
        (-1.0, 0.0, (-0.05, 0.0)),
        (1.0, 0.004, (0.0, 0.06)),
        (0.8, 0.0, (0.0, 0.035)),
        (-1.2, 0.0, (-0.04, 0.0)),
        (1.0, 0.0, (0.005, 0.036)),
        (-0.9, -0.003, (-0.045, -0.006)),
    ])
}

/// Three prismatic joints and turns; the last link's z axis points down.
fn gantry(draw: &mut Draw, model: &mut Model) -> usize {
    let mut link = 0;
    let half = draw.range(0.35, 0.6);
    for (name, axis) in [("slide_x", [1.0, 0.0, 0.0]), ("slide_y", [0.0, 1.0, 0.0])] {
        let place = if name == "slide_x" { Place::at(0.0, 0.0, 1.2) } else { Place::default() };
        link = model.joint(name, Motion::Prismatic, link, place, axis);
        model.last_joint().limits = (-half, half);
        if draw.chance(0.5) {
            let sides = if name == "slide_x" { [0.05, 2.0 * half, 0.04] } else { [0.09, 0.09, 0.07] };
            let height = if name == "slide_x" { 0.33 } else { 0.26 };
            model.shape(link, Place::at(0.0, 0.0, height), &cuboid(sides));
        }
    }
    let place = Place { xyz: [0.0; 3], rpy: [0.0, PI, 0.0] };
    link = model.joint("slide_z", Motion::Prismatic, link, place, [0.0, 0.0, 1.0]);
    model.last_joint().limits = (0.0, 0.62);
    let column = within(draw, model, [0.04, 0.04, 0.3]);
    model.shape(link, Place::at(0.0, 0.0, -0.05), &column);
    let turns = draw.index(4);
    if turns > 0 {
        let motion = draw.of(&[Motion::Revolute, Motion::Continuous]);
        link = model.joint("yaw", motion, link, Place::at(0.0, 0.0, 0.12), [0.0, 0.0, 1.0]);
        model.last_joint().limits = (-1.6, 1.6);
    } else {
        link = model.joint("flange", Motion::Fixed, link, Place::at(0.0, 0.0, 0.12), [0.0, 0.0, 1.0]);
    }
    if turns > 2 {
        let geometry = within(draw, model, [0.03, 0.03, 0.05]);
        model.shape(link, Place::default(), &geometry);
        link = model.joint("tilt", Motion::Revolute, link, Place::at(0.0, 0.0, 0.04), [1.0, 0.0, 0.0]);
        model.last_joint().limits = (-0.7, 0.7);
    }
    link
}

/// A chain of joints of all kinds, each link along the z axis of its frame.
fn arm(draw: &mut Draw, model: &mut Model, name: &str, mut place: Place, joints: usize) -> usize {
    let mut link = 0;
    let length = 1.0 / joints as f64;
    for number in 0..joints {
        let axis = match (number % 2, draw.index(8)) {
            (_, 0) => [0.6, 0.0, 0.8],
            (_, 1) => [1.0, 0.0, 0.0],
            (0, _) => [0.0, 0.0, 1.0],
            _ => [0.0, 1.0, 0.0],
        };
        let motion = match draw.index(12) {
            0 | 1 => Motion::Prismatic,
            2 | 3 => Motion::Continuous,
            _ => Motion::Revolute,
        };
        link = model.joint(&format!("{name}{number}"), motion, link, place, axis);
        model.last_joint().limits = match motion {
            Motion::Prismatic => (draw.range(-0.15, 0.0), draw.range(0.05, 0.2)),
            _ => (draw.range(-2.8, -0.8), draw.range(0.8, 2.8)),
        };
        let reach = draw.range(0.6 * length, 1.4 * length);
        limb(draw, model, link, reach);
        place = Place::at(0.0, 0.0, reach);
        if draw.chance(0.15) {
            link = model.joint(&format!("{name}{number}_bend"), Motion::Fixed, link, place, [0.0, 0.0, 1.0]);
            place = Place { xyz: [0.0, 0.0, 0.03], rpy: [draw.range(-0.5, 0.5), 0.0, 0.0] };
        }
    }
    let tip = model.joint(&format!("{name}_tip"), Motion::Fixed, link, place, [0.0, 0.0, 1.0]);
    if draw.chance(0.5) {
        let geometry = within(draw, model, [0.04, 0.04, 0.03]);
        model.shape(tip, Place::default(), &geometry);
    }
    tip
}

/// Shapes of a link of that length: none, one that ends before its neighbours or reaches into them, or several.
fn limb(draw: &mut Draw, model: &mut Model, link: usize, length: f64) {
    if draw.chance(0.12) {
        return;
    }
    let share = draw.range(0.5, 1.2);
    let sides = [draw.range(0.03, 0.08), draw.range(0.03, 0.08), super::draw::rounded(share * length)];
    let geometry = within(draw, model, sides);
    model.shape(link, Place::at(0.0, 0.0, super::draw::rounded(length / 2.0)), &geometry);
    if draw.chance(0.25) {
        let geometry = within(draw, model, [0.05, 0.05, 0.05]);
        let place = Place { xyz: [draw.range(0.03, 0.07), 0.0, length], rpy: [0.0, draw.range(-1.5, 1.5), 0.0] };
        model.shape(link, place, &geometry);
    }
}
