//! A robot description in memory, its forward kinematics, and its files.

use super::draw::Draw;
use foliate::components::Pose;
use foliate::components::pose::rotation_from_rpy;
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Where something is in its parent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place {
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
}

impl Place {
    pub fn at(x: f64, y: f64, z: f64) -> Self {
        Self { xyz: [x, y, z], rpy: [0.0; 3] }
    }

    pub fn pose(&self) -> Pose {
        let [roll, pitch, yaw] = self.rpy;
        Pose::from_parts(DVec3::from_array(self.xyz), rotation_from_rpy(roll, pitch, yaw))
    }

    fn xml(&self) -> String {
        let ([x, y, z], [roll, pitch, yaw]) = (self.xyz, self.rpy);
        format!("xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"")
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
}

#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub motion: Motion,
    pub parent: usize,
    pub child: usize,
    pub place: Place,
    pub axis: [f64; 3],
    pub limits: (f64, f64),
    /// Leader, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
}

#[derive(Clone, Debug, Default)]
pub struct Link {
    pub name: String,
    /// Where each shape is, and its geometry as XML.
    pub shapes: Vec<(Place, String)>,
}

/// A robot, an object or an environment.
#[derive(Clone, Debug, Default)]
pub struct Model {
    pub name: String,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
    /// Elements of the SRDF; none where there is no such file.
    pub srdf: Option<Vec<String>>,
    /// Whether capsules may be among its shapes: URDF readers other than ours do not know them.
    pub capsules: bool,
    /// Mesh files by name.
    pub meshes: Vec<(String, Vec<u8>)>,
}

impl Model {
    pub fn new(name: &str) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    pub fn link(&mut self, name: &str) -> usize {
        self.links.push(Link { name: name.into(), shapes: Vec::new() });
        self.links.len() - 1
    }

    /// A joint to a new link that is called like it.
    pub fn joint(&mut self, name: &str, motion: Motion, parent: usize, place: Place, axis: [f64; 3]) -> usize {
        let child = self.link(&format!("{name}_link"));
        let (name, limits) = (name.to_owned(), (-1.0, 1.0));
        self.joints.push(Joint { name, motion, parent, child, place, axis, limits, mimic: None });
        child
    }

    pub fn last_joint_name(&self) -> &str {
        &self.joints.last().expect("a joint").name
    }

    pub fn last_joint(&mut self) -> &mut Joint {
        self.joints.last_mut().expect("a joint")
    }

    pub fn shape(&mut self, link: usize, place: Place, geometry: &str) {
        self.links[link].shapes.push((place, geometry.into()));
    }

    /// Joints with a coordinate of their own.
    pub fn leaders(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|j| j.motion != Motion::Fixed && j.mimic.is_none())
    }

    /// A value for every joint with a coordinate; followers stay within their own limits too where that can be.
    pub fn random_values(&self, draw: &mut Draw) -> BTreeMap<String, f64> {
        let mut values = BTreeMap::new();
        for joint in self.leaders() {
            let (mut low, mut high) = match joint.motion {
                Motion::Continuous => (-3.0, 3.0),
                _ => joint.limits,
            };
            for follower in &self.joints {
                if let Some((leader, factor, offset)) = &follower.mimic
                    && *leader == joint.name
                    && follower.motion != Motion::Continuous
                {
                    let (a, b) = ((follower.limits.0 - offset) / factor, (follower.limits.1 - offset) / factor);
                    (low, high) = (low.max(a.min(b)), high.min(a.max(b)));
                }
            }
            let inset = 0.01 * (high - low).max(0.0);
            values.insert(joint.name.clone(), draw.range(low + inset, (high - inset).max(low + inset)));
        }
        values
    }

    fn value(&self, joint: &Joint, values: &BTreeMap<String, f64>) -> f64 {
        match &joint.mimic {
            Some((leader, factor, offset)) => factor * values.get(leader).copied().unwrap_or(0.0) + offset,
            None => values.get(&joint.name).copied().unwrap_or(0.0),
        }
    }

    /// Poses of all links in the root link's frame; parents come before children.
    pub fn poses(&self, values: &BTreeMap<String, f64>) -> Vec<Pose> {
        let mut poses = vec![Pose::identity(); self.links.len()];
        for joint in &self.joints {
            let (value, axis) = (self.value(joint, values), DVec3::from_array(joint.axis).normalize());
            let moved = match joint.motion {
                Motion::Fixed => Pose::identity(),
                Motion::Prismatic => Pose::from_translation(axis * value),
                _ => Pose::from_rotation(DQuat::from_axis_angle(axis, value)),
            };
            poses[joint.child] = poses[joint.parent] * joint.place.pose() * moved;
        }
        poses
    }

    pub fn urdf(&self) -> String {
        let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", self.name);
        for link in &self.links {
            let _infallible = writeln!(text, "  <link name=\"{}\">", link.name);
            for (place, geometry) in &link.shapes {
                let origin = place.xml();
                let _infallible =
                    writeln!(text, "    <collision><origin {origin}/><geometry>{geometry}</geometry></collision>");
            }
            text.push_str("  </link>\n");
        }
        for joint in &self.joints {
            text.push_str(&self.joint_xml(joint));
        }
        text + "</robot>\n"
    }

    fn joint_xml(&self, joint: &Joint) -> String {
        let kind = match joint.motion {
            Motion::Revolute => "revolute",
            Motion::Continuous => "continuous",
            Motion::Prismatic => "prismatic",
            Motion::Fixed => "fixed",
        };
        let (name, (parent, child)) = (&joint.name, (&self.links[joint.parent].name, &self.links[joint.child].name));
        let ([x, y, z], (low, high)) = (joint.axis, joint.limits);
        let limits = match joint.motion {
            Motion::Fixed | Motion::Continuous => String::new(),
            _ => format!("<limit lower=\"{low}\" upper=\"{high}\" velocity=\"1\" effort=\"1\"/>"),
        };
        let axis = match joint.motion {
            Motion::Fixed => String::new(),
            _ => format!("<axis xyz=\"{x} {y} {z}\"/>"),
        };
        let mimic = joint.mimic.as_ref().map_or(String::new(), |(leader, factor, offset)| {
            format!("<mimic joint=\"{leader}\" multiplier=\"{factor}\" offset=\"{offset}\"/>")
        });
        let origin = joint.place.xml();
        format!(
            "  <joint name=\"{name}\" type=\"{kind}\"><origin {origin}/><parent link=\"{parent}\"/>\
             <child link=\"{child}\"/>{axis}{limits}{mimic}</joint>\n"
        )
    }

    pub fn srdf_text(&self) -> Option<String> {
        let elements = self.srdf.as_ref()?;
        Some(format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n{}\n</robot>\n", self.name, elements.join("\n")))
    }
}
