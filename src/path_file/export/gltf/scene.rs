//! Nodes, meshes and the animation of a trajectory.
//!
//! The node `foliate` turns the world, whose z points up, to glTF's, whose y does. Below it every joint is a node: joints that turn or shift
//! their bodies are animated in their parents' frames, roots of objects in the world, where they follow what carries them.

use crate::path_file::export::gltf::buffer::Buffer;
use crate::path_file::export::options::{ExportError, ExportOptions, fits};
use crate::planner::trajectory::trajectory::Trajectory;
use crate::scene::surface::Surface;
use crate::scene::visuals::{Visual, Visuals};
use foliate_components::Pose;
use foliate_components::robot::shape::Geometry;
use foliate_components::robot::{JointIndex, PartKind, Robot};
use glam::DQuat;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// Most bytes of a file; its header counts them with 32 bits.
const BYTES: usize = 1 << 31;
/// What moves by less than this does not, metres and radians.
const STILL: f64 = 1e-7;
/// Colours of what has none: robots, objects, environments.
const ROBOT: [f64; 4] = [0.75, 0.77, 0.8, 1.0];
const OBJECT: [f64; 4] = [0.9, 0.55, 0.2, 1.0];
const ENVIRONMENT: [f64; 4] = [0.55, 0.55, 0.5, 1.0];

/// A trajectory as an animated scene, binary glTF 2.0. Positions are metres, times seconds from the start; the animation is sampled at the
/// rate, last at the end.
///
/// # Errors
/// The rate is none; there are more than 2²⁶ numbers; the scene has more than 2 GiB.
pub fn glb(trajectory: &Trajectory<'_>, visuals: &Visuals, options: &ExportOptions) -> Result<Vec<u8>, ExportError> {
    let times: Vec<f64> = trajectory.sample_times(options.rate)?.collect();
    fits(times.len(), 7 * trajectory.robot().joints.len())?;
    let in_parents = in_parents(trajectory, &times);
    let mut scene = Scene::default();
    let bodies = scene.nodes(trajectory.robot(), visuals, &in_parents);
    let seconds: Vec<f64> = times.iter().map(|time| time - trajectory.start()).collect();
    let animation = animation(&seconds, &in_parents, &bodies, &mut scene.buffer);
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "foliate" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": scene.nodes,
        "accessors": scene.buffer.accessors,
        "bufferViews": scene.buffer.views,
        "buffers": [{ "byteLength": scene.buffer.bytes.len() }],
    });
    // An empty list is no list in glTF.
    let lists = [("meshes", scene.meshes), ("materials", scene.materials), ("animations", animation)];
    for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
        document[key] = list.into();
    }
    if scene.buffer.bytes.is_empty() {
        ["accessors", "bufferViews", "buffers"]
            .iter()
            .for_each(|key| drop(document.as_object_mut().map(|d| d.remove(*key))));
    }
    packed(&document, &scene.buffer.bytes)
}

/// Header, JSON and binary chunk.
fn packed(document: &Value, binary: &[u8]) -> Result<Vec<u8>, ExportError> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunks: usize = [text.len(), binary.len()].iter().map(|length| 8 + length).sum();
    if 12 + chunks > BYTES {
        return Err(ExportError::TooLarge("the scene has more than 2 GiB: lower the rate"));
    }
    let chunks = if binary.is_empty() { 8 + text.len() } else { chunks };
    let mut out = Vec::with_capacity(12 + chunks);
    let number = |out: &mut Vec<u8>, n: usize| out.extend((n as u32).to_le_bytes());
    out.extend(b"glTF");
    number(&mut out, 2);
    number(&mut out, 12 + chunks);
    number(&mut out, text.len());
    out.extend(b"JSON");
    out.extend(text);
    if !binary.is_empty() {
        number(&mut out, binary.len());
        out.extend(b"BIN\0");
        out.extend(binary);
    }
    Ok(out)
}

/// A scene that is being built.
#[derive(Default)]
struct Scene {
    buffer: Buffer,
    nodes: Vec<Value>,
    children: Vec<Vec<usize>>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    /// Accessors of surfaces that are there already, by the mesh's address.
    surfaces: HashMap<usize, Option<(usize, usize)>>,
    /// Meshes by their surface and material.
    known: HashMap<(usize, usize, usize), usize>,
}

impl Scene {
    /// A node for each body and each link, where they are at the start; the numbers of the bodies' nodes.
    fn nodes(&mut self, robot: &Robot, visuals: &Visuals, in_parents: &[Vec<Pose>]) -> Vec<usize> {
        let turn = Pose::from_rotation(DQuat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2));
        let world = self.node("foliate", &turn, None);
        let mut bodies = Vec::with_capacity(robot.joints.len());
        for (joint, poses) in robot.joints.iter().zip(in_parents) {
            let parent = joint.parent.map_or(world, |parent| bodies[parent.at()]);
            bodies.push(self.node(&joint.name, &poses[0], Some(parent)));
        }
        for (index, link) in robot.links.iter().enumerate() {
            let parent = link.joint.map_or(world, |joint| bodies[joint.at()]);
            let node = self.node(&link.name, &link.joint_from_link, Some(parent));
            let usual = match robot.parts[link.part.at()].kind {
                PartKind::Robot => ROBOT,
                PartKind::Object => OBJECT,
                PartKind::Environment => ENVIRONMENT,
            };
            for visual in &visuals.links[index] {
                let Some(mesh) = self.mesh(visual, visual.color.unwrap_or(usual)) else { continue };
                let shown = self.node(&format!("{} (visual)", link.name), &visual.link_from_visual, Some(node));
                self.nodes[shown]["mesh"] = mesh.into();
            }
        }
        for (node, children) in self.nodes.iter_mut().zip(&self.children) {
            if !children.is_empty() {
                node["children"] = children.clone().into();
            }
        }
        bodies
    }

    fn node(&mut self, name: &str, pose: &Pose, parent: Option<usize>) -> usize {
        let mut node = Map::new();
        node.insert("name".into(), name.into());
        node.insert("translation".into(), pose.translation.to_array().to_vec().into());
        node.insert("rotation".into(), pose.rotation.normalize().to_array().to_vec().into());
        self.nodes.push(node.into());
        self.children.push(Vec::new());
        let number = self.nodes.len() - 1;
        parent.into_iter().for_each(|parent| self.children[parent].push(number));
        number
    }

    /// The mesh of a solid in a colour; meshes of one file are stored once.
    fn mesh(&mut self, visual: &Visual, color: [f64; 4]) -> Option<usize> {
        let (positions, corners) = match &visual.geometry {
            Geometry::Mesh(mesh) => {
                let address = Arc::as_ptr(mesh) as usize;
                match self.surfaces.get(&address) {
                    Some(known) => *known,
                    None => {
                        let added = self.surface(&visual.geometry);
                        self.surfaces.insert(address, added);
                        added
                    }
                }
            }
            primitive => self.surface(primitive),
        }?;
        let material = self.material(color);
        let key = (positions, corners, material);
        if let Some(&mesh) = self.known.get(&key) {
            return Some(mesh);
        }
        let primitive = json!({ "attributes": { "POSITION": positions }, "indices": corners, "material": material });
        self.meshes.push(json!({ "primitives": [primitive] }));
        self.known.insert(key, self.meshes.len() - 1);
        Some(self.meshes.len() - 1)
    }

    fn surface(&mut self, geometry: &Geometry) -> Option<(usize, usize)> {
        let surface = Surface::of(geometry)?;
        let positions = self.buffer.positions(&surface.vertices);
        Some((positions, self.buffer.corners(&surface.triangles, surface.vertices.len())))
    }

    fn material(&mut self, color: [f64; 4]) -> usize {
        // URDFs write colours as screens show them; glTF multiplies light.
        let [r, g, b, a] = color;
        let linear = |c: f64| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        let surface = json!({
            "baseColorFactor": [linear(r), linear(g), linear(b), a], "metallicFactor": 0.0, "roughnessFactor": 0.7,
        });
        let mut material = json!({ "pbrMetallicRoughness": surface, "doubleSided": true });
        if a < 1.0 {
            material["alphaMode"] = "BLEND".into();
        }
        match self.materials.iter().position(|known| *known == material) {
            Some(known) => known,
            None => {
                self.materials.push(material);
                self.materials.len() - 1
            }
        }
    }
}

/// By body its poses in the frame of its parent's body, or in the world, sample by sample.
fn in_parents(trajectory: &Trajectory<'_>, times: &[f64]) -> Vec<Vec<Pose>> {
    let joints = &trajectory.robot().joints;
    let mut in_parents: Vec<Vec<Pose>> = vec![Vec::with_capacity(times.len()); joints.len()];
    let mut poses = trajectory.poses();
    for &time in times {
        poses.place(time);
        for (index, joint) in joints.iter().enumerate() {
            let body = poses.body(JointIndex(index as u32));
            in_parents[index].push(joint.parent.map_or(body, |parent| poses.body(parent).inverse() * body));
        }
    }
    in_parents
}

/// The animation of what moves. `seconds` are the times of the samples from the start.
fn animation(seconds: &[f64], in_parents: &[Vec<Pose>], bodies: &[usize], buffer: &mut Buffer) -> Vec<Value> {
    // In single precision two times may be one.
    let (mut times, mut kept): (Vec<f32>, Vec<usize>) = (Vec::new(), Vec::new());
    for (index, second) in seconds.iter().map(|second| *second as f32).enumerate() {
        if times.last().is_none_or(|last| *last < second) {
            times.push(second);
            kept.push(index);
        }
    }
    let (mut channels, mut samplers, mut input) = (Vec::new(), Vec::new(), None);
    for (node, poses) in bodies.iter().zip(in_parents) {
        let first = &poses[0];
        let shifts = poses.iter().any(|pose| (pose.translation - first.translation).abs().max_element() > STILL);
        let turns = poses.iter().any(|pose| 1.0 - pose.rotation.dot(first.rotation).abs() > STILL * STILL);
        let mut channel = |path: &str, output: usize, input: usize| {
            channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        };
        if shifts {
            let input = *input.get_or_insert_with(|| buffer.times(&times));
            let values: Vec<[f32; 3]> =
                kept.iter().map(|&k| poses[k].translation.to_array().map(|x| x as f32)).collect();
            channel("translation", buffer.values(&values), input);
        }
        if turns {
            let input = *input.get_or_insert_with(|| buffer.times(&times));
            channel("rotation", buffer.values(&continuous(kept.iter().map(|&k| poses[k].rotation))), input);
        }
    }
    match channels.is_empty() {
        true => Vec::new(),
        false => vec![json!({ "name": "trajectory", "channels": channels, "samplers": samplers })],
    }
}

/// Unit quaternions of which each is on the side of the one before.
fn continuous(rotations: impl Iterator<Item = DQuat>) -> Vec<[f32; 4]> {
    let mut last = DQuat::IDENTITY;
    let next = |rotation: DQuat| {
        let rotation = rotation.normalize();
        last = if last.dot(rotation) < 0.0 { -rotation } else { rotation };
        last.to_array().map(|x| x as f32)
    };
    rotations.map(next).collect()
}
