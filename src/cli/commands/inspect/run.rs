//! What was read from a model.

use crate::cli::commands::inspect::found;
use crate::cli::commands::solve::coverage;
use crate::cli::console::loading;
use crate::cli::console::print::{Ending, Refusal, print, print_json};
use crate::components::Pose;
use crate::components::pose::pose_to_array;
use crate::components::robot::model::{JointKind, JointModel, Model};
use crate::components::robot::shape::Geometry;
use crate::components::robot::{Robot, ShapeIndex};
use crate::inspection::{Inspection, inspect_pairs};
use crate::scene::{PackagePath, SceneError, UpAxis, read_model};
use crate::setup::collision_matrix::{CollisionMatrix, MatrixSettings, collision_matrix};
use crate::setup::grippers::{FoundGripper, hands};
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Duration;

/// Reads a model as a scene would, and prints what it found
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// URDF: a file, or a package:// URL
    #[arg(value_name = "MODEL.urdf")]
    urdf: String,
    /// SRDF: a file, or a package:// URL
    #[arg(long, value_name = "FILE")]
    srdf: Option<String>,
    /// What is done with the up axis of COLLADA and glTF meshes
    #[arg(long, value_name = "as-written|declared", value_parser = loading::up_axis, default_value = "as-written")]
    mesh_up_axis: UpAxis,
    /// List every pair of collision shapes that is not tested, with the reason
    #[arg(long)]
    pairs: bool,
    /// List which links touch in random configurations: pairs that touch by design, at the default configuration, sometimes
    #[arg(long)]
    collision_matrix: bool,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments, packages: &PackagePath) -> Result<Ending, Refusal> {
    let (urdf, srdf, mine) = (arguments.urdf.clone(), arguments.srdf.clone(), packages.clone());
    let (up_axis, wants_matrix) = (arguments.mesh_up_axis, arguments.collision_matrix);
    let Ok((read, robot, pairs, matrix, grippers)) = loading::beside(Duration::MAX, Duration::ZERO, move |stop| {
        let mut read = read_model(&urdf, srdf.as_deref(), up_axis, &loading::until(&mine, stop))?;
        let robot = read.compose_alone()?;
        let pairs = inspect_pairs(&robot);
        let matrix = wants_matrix.then(|| collision_matrix(&robot, MatrixSettings::default()));
        let grippers = hands(&robot);
        Ok((read, robot, pairs, matrix, grippers))
    })?
    else {
        return Ok(Ending::Interrupted);
    };
    let found = Found {
        pairs: pairs.as_ref(),
        lists_pairs: arguments.pairs,
        matrix: matrix.as_ref(),
        found: &grippers,
        model: &read.model,
        robot: &robot,
        warnings: &read.warnings,
        tree: tree(&read.model),
    };
    match arguments.json {
        true => print_json(&found.json())?,
        false => print(&found.text()),
    }
    Ok(Ending::Done)
}

struct Found<'a> {
    model: &'a Model,
    robot: &'a Robot,
    warnings: &'a [SceneError],
    /// `None` where pairs of shapes were not tested.
    pairs: Option<&'a Inspection>,
    /// Whether every pair that is left out is told.
    lists_pairs: bool,
    /// Which links touch, where that was asked for.
    matrix: Option<&'a CollisionMatrix>,
    /// Grippers that no document names.
    found: &'a [FoundGripper],
    /// Joints in depth-first order, with their depth.
    tree: Vec<(usize, &'a JointModel)>,
}

/// The joints in pinocchio's order: depth first, children by name.
fn tree(model: &Model) -> Vec<(usize, &JointModel)> {
    let mut below: Vec<Vec<&JointModel>> = vec![Vec::new(); model.links.len()];
    let mut is_child = vec![false; model.links.len()];
    for joint in &model.joints {
        below[joint.parent].push(joint);
        is_child[joint.child] = true;
    }
    below.iter_mut().for_each(|joints| joints.sort_by(|a, b| b.name.cmp(&a.name)));
    let roots = (0..model.links.len()).filter(|&l| !is_child[l]);
    let mut stack: Vec<_> = roots.flat_map(|l| below[l].iter().map(|&j| (0, j))).collect();
    let mut walked = Vec::with_capacity(model.joints.len());
    while let Some((depth, joint)) = stack.pop() {
        walked.push((depth, joint));
        stack.extend(below[joint.child].iter().map(|&j| (depth + 1, j)));
    }
    walked
}

fn kind(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Fixed => "fixed",
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
        JointKind::Planar => "planar",
        JointKind::Floating => "floating",
    }
}

fn mask(mask: [bool; 6]) -> String {
    mask.iter().map(|m| if *m { '1' } else { '0' }).collect()
}

/// One shape in words.
fn shape(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Sphere { radius } => format!("sphere, radius {radius}"),
        Geometry::Box { half_extents } => {
            let size = *half_extents * 2.0;
            format!("box {} x {} x {}", size.x, size.y, size.z)
        }
        Geometry::Cylinder { radius, half_length } => {
            format!("cylinder, radius {radius}, length {}", 2.0 * half_length)
        }
        Geometry::Capsule { radius, half_length } => format!("capsule, radius {radius}, length {}", 2.0 * half_length),
        Geometry::Mesh(mesh) => {
            let closed = if mesh.closed { "" } else { ", not closed" };
            format!("mesh of {} triangles{closed}, {}", mesh.triangles.len(), mesh.source)
        }
    }
}

impl Found<'_> {
    fn triangles(&self) -> usize {
        self.model.links.iter().flat_map(|l| &l.shapes).map(|(_, g)| triangles(g)).sum()
    }

    fn text(&self) -> String {
        let (model, mut out) = (self.model, String::new());
        let moving = self.robot.joints.len();
        let free = self.robot.space.dimension();
        let shapes: usize = model.links.iter().map(|l| l.shapes.len()).sum();
        let _ = writeln!(
            out,
            "{}: {} links, {} joints of which {moving} move, {free} degrees of freedom without a root",
            model.name,
            model.links.len(),
            model.joints.len()
        );
        if moving > 0 {
            let _ = writeln!(out, "\nJoints (indented below the joint that carries them)");
        }
        for (depth, joint) in &self.tree {
            self.joint(&mut out, *depth, joint);
        }
        let _ = writeln!(out, "\nCollision shapes: {shapes}, {} triangles", self.triangles());
        for link in model.links.iter().filter(|l| !l.shapes.is_empty()) {
            for (_, geometry) in &link.shapes {
                let _ = writeln!(out, "  {}: {}", link.name, shape(geometry));
            }
        }
        self.documents(&mut out);
        found::poses(self.model, self.robot, self.found, &mut out);
        self.coverage(&mut out);
        if let Some(matrix) = self.matrix {
            found::matrix(self.robot, matrix, &mut out);
        }
        let remarks = self.remarks();
        let _ = writeln!(out, "\nWarnings: {}", remarks.len());
        for warning in remarks {
            let _ = writeln!(out, "  {warning}");
        }
        out
    }

    fn joint(&self, out: &mut String, depth: usize, joint: &JointModel) {
        let indent = "  ".repeat(depth.min(40) + 1);
        let _ = write!(out, "{indent}{} {} -> {}", joint.name, kind(joint.kind), self.model.links[joint.child].name);
        if matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic) {
            let _ = write!(out, " [{}, {}]", joint.limits.0, joint.limits.1);
        }
        if let Some((leader, multiplier, offset)) = &joint.mimic {
            let _ = write!(out, " follows {multiplier} x {leader} + {offset}");
        }
        out.push('\n');
    }

    /// Which pairs of shapes a scene would test.
    fn coverage(&self, out: &mut String) {
        let Some(pairs) = self.pairs else {
            let _ = writeln!(out, "\nPairs of shapes: too many to list");
            return;
        };
        let _ = writeln!(out, "\nPairs of shapes: {}", coverage::sentence(&pairs.counts));
        for (first, second) in &pairs.always_colliding {
            let (first, second) = (self.shape(*first), self.shape(*second));
            let _ =
                writeln!(out, "\nAlways in collision: {first} and {second}; disable the pair in the SRDF or the scene");
        }
        if self.lists_pairs {
            let _ = writeln!(out, "\nNot tested:");
            for pair in &pairs.left_out {
                let _ = writeln!(out, "  {}", coverage::line(pair, &pairs.apart, |shape| self.shape(shape)));
            }
        }
    }

    /// A shape's name without that of the part, which is `model` here.
    fn shape(&self, shape: ShapeIndex) -> &str {
        let name = self.robot.shapes[shape.at()].name.as_str();
        name.strip_prefix("model/").unwrap_or(name)
    }

    /// What is remarkable: what the files say, and what the pairs do.
    fn remarks(&self) -> Vec<String> {
        let mut remarks: Vec<String> = self.warnings.iter().map(ToString::to_string).collect();
        if let Some(warning) = self.pairs.and_then(|p| coverage::apart_warning(&p.apart, "the neutral configuration")) {
            remarks.push(warning);
        }
        remarks
    }

    fn documents(&self, out: &mut String) {
        let model = self.model;
        if !model.has_srdf {
            let _ = writeln!(
                out,
                "\nNo SRDF was given: links that one joint joins and that touch wherever it is are not tested for collision."
            );
            return;
        }
        let _ = writeln!(out, "\nGrippers: {}", model.grippers.len());
        for g in &model.grippers {
            let _ = writeln!(out, "  {} on {}, clearance {}", g.name, g.link, g.clearance);
        }
        let _ = writeln!(out, "Handles: {}", model.handles.len());
        for h in &model.handles {
            let _ = writeln!(out, "  {} on {}, mask {}, clearance {}", h.name, h.link, mask(h.mask), h.clearance);
        }
        let _ = writeln!(out, "Surfaces: {}", model.surfaces.len());
        for s in &model.surfaces {
            let _ = writeln!(out, "  {} on {}, {} polygons", s.name, s.link, s.polygons.len());
        }
        let _ = writeln!(out, "Disabled pairs: {}", model.disabled_pairs.len());
        let states: Vec<_> = model.group_states.iter().map(|s| s.name.as_str()).collect();
        let _ = writeln!(out, "Named configurations: {}", states.join(", "));
    }

    fn json(&self) -> Value {
        let model = self.model;
        let links: Vec<_> = model.links.iter().map(|l| link(l.name.as_str(), &l.shapes)).collect();
        let joints: Vec<_> = self.tree.iter().map(|(_, j)| self.joint_json(j)).collect();
        let coordinates: Vec<_> =
            crate::scene::coordinate_names(self.robot).iter().map(|n| n["model/".len()..].to_owned()).collect();
        json!({
            "name": model.name,
            "degrees_of_freedom": self.robot.space.dimension(),
            "coordinates": coordinates,
            "triangles": self.triangles(),
            "links": links,
            "joints": joints,
            "grippers": model.grippers.iter().map(|g| json!({
                "name": g.name, "link": g.link, "link_from_gripper": pose_to_array(&g.link_from_gripper), "clearance": g.clearance,
            })).collect::<Vec<_>>(),
            "handles": model.handles.iter().map(|h| json!({
                "name": h.name, "link": h.link, "link_from_handle": pose_to_array(&h.link_from_handle), "clearance": h.clearance,
                "mask": mask(h.mask), "mask_complement": mask(h.mask_complement),
                "approaching_direction": h.approaching_direction.to_array(),
            })).collect::<Vec<_>>(),
            "surfaces": model.surfaces.iter().map(|s| json!({
                "name": s.name, "link": s.link, "points": s.points.iter().map(|p| p.to_array()).collect::<Vec<_>>(), "polygons": s.polygons,
            })).collect::<Vec<_>>(),
            "disabled_pairs": model.disabled_pairs,
            "configurations": model.group_states.iter().map(|s| json!({ "name": s.name, "values": s.values })).collect::<Vec<_>>(),
            "always_colliding": self.pairs.map(|p| p.always_colliding.iter().map(|&(a, b)| [self.shape(a), self.shape(b)]).collect::<Vec<_>>()),
            "pairs": self.pairs.map(|p| coverage::counts_json(&p.counts)),
            "pairs_left_out": self.pairs.filter(|_| self.lists_pairs).map(|p| coverage::list_json(&p.left_out, &p.apart, |shape| self.shape(shape))),
            "link_poses": found::poses_json(self.robot),
            "found_grippers": found::grippers_json(self.robot, self.found),
            "collision_matrix": self.matrix.map(|matrix| found::matrix_json(self.robot, matrix)),
            "warnings": self.remarks(),
        })
    }

    fn joint_json(&self, j: &JointModel) -> Value {
        let limits = matches!(j.kind, JointKind::Revolute | JointKind::Prismatic).then_some([j.limits.0, j.limits.1]);
        json!({
            "name": j.name, "kind": kind(j.kind),
            "parent": self.model.links[j.parent].name, "child": self.model.links[j.child].name,
            "parent_from_joint": pose_to_array(&j.parent_from_joint), "axis": j.axis.to_array(),
            "limits": limits, "velocity_limit": j.velocity_limit, "mimic": j.mimic,
        })
    }
}

fn triangles(geometry: &Geometry) -> usize {
    match geometry {
        Geometry::Mesh(mesh) => mesh.triangles.len(),
        _ => 0,
    }
}

fn link(name: &str, shapes: &[(Pose, Geometry)]) -> Value {
    let shapes: Vec<_> = shapes
        .iter()
        .map(|(pose, geometry)| {
            let size = match geometry {
                Geometry::Sphere { radius } => json!({ "radius": radius }),
                Geometry::Box { half_extents } => json!({ "size": (*half_extents * 2.0).to_array() }),
                Geometry::Cylinder { radius, half_length } | Geometry::Capsule { radius, half_length } => {
                    json!({ "radius": radius, "length": 2.0 * half_length })
                }
                Geometry::Mesh(mesh) => json!({
                    "file": mesh.source, "triangles": mesh.triangles.len(), "closed": mesh.closed, "bounds": bounds(&mesh.vertices),
                }),
            };
            json!({ "kind": geometry.kind(), "link_from_shape": pose_to_array(pose), "geometry": size })
        })
        .collect();
    json!({ "name": name, "shapes": shapes })
}

/// Lower and upper corner of the box that holds the points.
fn bounds(points: &[glam::DVec3]) -> [[f64; 3]; 2] {
    let low = points.iter().copied().reduce(glam::DVec3::min).unwrap_or_default();
    let high = points.iter().copied().reduce(glam::DVec3::max).unwrap_or_default();
    [low.to_array(), high.to_array()]
}
