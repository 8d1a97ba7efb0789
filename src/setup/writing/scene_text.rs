//! A scene file with comments, from what was found.

use crate::scene::assemble::start_tolerance::MOST_RESIDUAL;
use crate::setup::collision_matrix::{CollisionMatrix, PairReason};
use crate::setup::grippers::FoundGripper;
use crate::setup::handles::FoundHandle;
use crate::setup::new_scene::DRIVES;
use crate::setup::surfaces::FoundSurface;
use crate::setup::writing::numbers::{list, mask, number, number_within, point, pose, quoted};
use foliate_components::Pose;
use foliate_components::robot::{JointIndex, LinkIndex, Robot, Source};
use std::fmt::Write;

/// Most pairs that a comment lists.
const LISTED: usize = 24;

/// What a scene is written from.
pub(crate) struct Draft<'a> {
    /// The scene's name.
    pub name: String,
    /// The command that made it.
    pub command: String,
    /// The robot alone; its part is called `robot`.
    pub robot: &'a Robot,
    pub urdf: String,
    pub srdf: Option<String>,
    pub robot_height: f64,
    pub matrix: &'a CollisionMatrix,
    pub grippers: &'a [FoundGripper],
    pub table: TableText,
    pub objects: Vec<ObjectText<'a>>,
    /// By gripper, the handles that it may hold; none where each may hold all.
    pub grasps: Option<Vec<(String, Vec<String>)>>,
    /// Joints that are no part of an arm or a hand.
    pub locked: Vec<JointIndex>,
    /// Of the robot's joints.
    pub q: Vec<f64>,
    /// How far the root drives along x and y, metres; none where it is fixed.
    pub drives: Option<f64>,
    /// Planar joints of the model, by name: it drives by them.
    pub driving: Vec<String>,
    /// Floating joints of the model, by name: they stand still.
    pub floating: Vec<String>,
    /// Where the first object goes, and by which grasp that is known to be within reach.
    pub goal: Pose,
    pub grasp: String,
    /// How closely an arm of few joints meets that grasp, metres and radians, where that is not as closely as searches want it.
    pub inexact: Option<f64>,
}

/// A table and its faces.
pub(crate) struct TableText {
    /// `urdf = …` or `shape = …`.
    pub source: String,
    pub pose: Pose,
    pub faces: Vec<FoundSurface>,
    /// Height of the top, metres.
    pub height: f64,
    /// Why it stands there.
    pub why: &'static str,
}

/// An object and what was found on it.
pub(crate) struct ObjectText<'a> {
    pub name: String,
    /// `urdf = …` or `shape = …`.
    pub source: String,
    pub link: String,
    pub handles: Vec<FoundHandle>,
    pub handles_from: String,
    pub faces: &'a [FoundSurface],
    /// Where it is a ball: how far its lowest point is below its origin, metres.
    pub ball: Option<f64>,
    pub start: Pose,
    pub root_bounds: [(f64, f64); 3],
}

impl Draft<'_> {
    /// The text.
    pub(crate) fn text(&self) -> String {
        let mut out = String::new();
        self.head(&mut out);
        self.robot_part(&mut out);
        self.table_part(&mut out);
        self.objects.iter().for_each(|object| object_part(object, &mut out));
        self.graph(&mut out);
        self.ends(&mut out);
        out
    }

    fn head(&self, out: &mut String) {
        let _ = writeln!(
            out,
            "# Written by {}\n\
             # Everything below was found in the models and may be edited: docs/scene-reference.md explains each key.\n\
             # Solve it:   foliate solve FILE          Look at it:   foliate view FILE\n\
             format = \"foliate.scene/1\"\n\
             name = {}\n\
             description = {}",
            self.command,
            quoted(&self.name),
            quoted(&format!("{} takes {} to another place on the table", self.robot_name(), self.objects[0].name)),
        );
        if let Some(residual) = self.inexact {
            let _ = writeln!(
                out,
                "# The arm has fewer than six joints, and axes in its URDF are not exactly parallel or square: it meets the grasp that was\n\
                 # tried to within {residual:.1e} (metres and radians). Constraints are therefore met less exactly than 1e-6.\n\
                 projection_tolerance = {MOST_RESIDUAL:e}"
            );
        }
    }

    fn robot_name(&self) -> &str {
        "A robot"
    }

    fn robot_part(&self, out: &mut String) {
        let _ = writeln!(out, "\n[[part]]\nname = \"robot\"\nkind = \"robot\"\nurdf = {}", quoted(&self.urdf));
        if let Some(srdf) = &self.srdf {
            let _ = writeln!(out, "srdf = {}", quoted(srdf));
        }
        if let Some(far) = self.drives {
            let bounds = list(&[-far, far]);
            let _ = writeln!(out, "root = \"planar\" # it drives\nroot_bounds = [{bounds}, {bounds}]");
        }
        if !self.driving.is_empty() {
            let bounds = list(&[-DRIVES, DRIVES]);
            let axes = self.driving.iter().flat_map(|joint| ["x", "y"].map(|axis| format!("{joint}/{axis}")));
            let axes: Vec<String> = axes.map(|name| format!("{} = {bounds}", quoted(&name))).collect();
            let _ = writeln!(out, "joint_bounds = {{ {} }} # it drives by a joint of its own", axes.join(", "));
        }
        if self.robot_height > 0.0 {
            let _ = writeln!(
                out,
                "# As high as the table: from the floor the hand is above the table too rarely.\n\
                 pose = {{ xyz = [0.0, 0.0, {}] }}",
                number(self.robot_height)
            );
        }
        self.ignore(out);
        for gripper in self.grippers {
            let _ = writeln!(out, "\n# Found: {}.\n# It {}.", gripper.reason, gripper.kind);
            let _ = writeln!(
                out,
                "[[part.gripper]]\nname = {}\nlink = {}\npose = {} # x approaches, y closes",
                quoted(&gripper.name),
                quoted(self.own(gripper.link)),
                pose(&gripper.link_from_gripper)
            );
        }
    }

    /// The links that are not tested against each other, and those that a person may think about.
    fn ignore(&self, out: &mut String) {
        let _ = writeln!(
            out,
            "# Links that touch by design are not tested against each other. Found in {} random configurations;\n\
             # `foliate inspect {} --collision-matrix` prints the whole table.\n\
             ignore = [",
            self.matrix.samples, self.urdf
        );
        let of = |reason: PairReason| self.matrix.pairs.iter().filter(move |pair| pair.reason == reason);
        let _ = writeln!(
            out,
            "    \"adjacent\", # neighbours that touch at every value of the joint between them, {} pairs",
            of(PairReason::Adjacent).count()
        );
        for pair in self.matrix.ignored().filter(|pair| pair.reason != PairReason::Adjacent) {
            let (first, second) = (quoted(self.own(pair.first)), quoted(self.own(pair.second)));
            let why = match pair.reason {
                PairReason::Telescope => "telescope: nested segments, within 1 mm in",
                PairReason::Mostly => "mostly: touch by default and in",
                _ => "always:",
            };
            let _ = writeln!(out, "    [{first}, {second}], # {why} {:.1} % of the samples", 100.0 * pair.share);
        }
        let _ = writeln!(out, "]");
        let tested = self.matrix.pairs.iter().filter(|pair| pair.reason == PairReason::Default);
        let tested: Vec<String> = tested
            .map(|pair| {
                format!("#   {} and {} ({:.1} %)", self.own(pair.first), self.own(pair.second), 100.0 * pair.share)
            })
            .collect();
        if !tested.is_empty() {
            let _ = writeln!(out, "# Tested, although they touch where all joints are at their default:");
            tested.iter().take(LISTED).for_each(|line| {
                let _ = writeln!(out, "{line}");
            });
        }
    }

    fn own(&self, link: LinkIndex) -> &str {
        let name = self.robot.links[link.at()].name.as_str();
        name.split_once('/').map_or(name, |(_, own)| own)
    }

    fn table_part(&self, out: &mut String) {
        let table = &self.table;
        let _ = writeln!(
            out,
            "\n[[part]]\nname = \"table\"\nkind = \"environment\"\n{}\npose = {} # {}",
            table.source,
            pose(&table.pose),
            table.why
        );
        table.faces.iter().for_each(|face| surface(face, out));
    }

    fn graph(&self, out: &mut String) {
        let _ = writeln!(out, "\n[graph]");
        for object in self.objects.iter().filter(|object| object.ball.is_some()) {
            let _ = writeln!(out, "# A ball lies on no face: it may be anywhere on the plane of the table.");
            let _ = writeln!(
                out,
                "objects.{} = {{ plane = {{ pose = {{ xyz = [0.0, 0.0, {}] }}, frame = {{ xyz = [0.0, 0.0, {}] }}, on = \"table/body\" }} }}",
                object.name,
                number(self.table.height),
                number(-object.ball.unwrap_or_default() - crate::setup::places::layout::GAP)
            );
        }
        if let Some(grasps) = &self.grasps {
            let _ = writeln!(out, "# Grippers of different sizes hold by handles of their own.\n[graph.grasps]");
            for (gripper, handles) in grasps {
                let names: Vec<String> = handles.iter().map(|name| quoted(name)).collect();
                let _ = writeln!(out, "{} = [{}]", quoted(gripper), names.join(", "));
            }
        }
        let hands: Vec<_> = self.grippers.iter().filter(|gripper| !gripper.fingers.is_empty()).collect();
        if !hands.is_empty() {
            let _ =
                writeln!(out, "\n# Fingers open and close beside objects; their bounds of the URDF.\n[graph.hands]");
        }
        for gripper in hands {
            let fingers = gripper.fingers.iter().map(|finger| {
                let joint = &self.robot.joints[finger.joint.at()];
                let bounds = (joint.lower[0], joint.upper[0]);
                let [open, closed] = [finger.open, finger.closed].map(|x| number_within(x, bounds));
                format!("{} = {{ open = {open}, closed = {closed}, travel = {open} }}", quoted(&joint.name))
            });
            let name = quoted(&format!("robot/{}", gripper.name));
            let _ = writeln!(out, "{name} = {{ fingers = {{ {} }} }}", fingers.collect::<Vec<_>>().join(", "));
        }
        if !self.locked.is_empty() || !self.floating.is_empty() {
            let _ = writeln!(out, "\n# Joints that move neither an arm nor a hand.\n[locked]");
            for joint in &self.floating {
                let _ = writeln!(out, "{} = {}", quoted(&format!("robot/{joint}")), pose(&Pose::IDENTITY));
            }
            for joint in &self.locked {
                let _ = writeln!(out, "{} = \"start\"", quoted(&self.robot.joints[joint.at()].name));
            }
        }
    }

    fn ends(&self, out: &mut String) {
        let _ = writeln!(out, "\n# Nothing collides here, and the fingers are open.\n[start]");
        if self.drives.is_some() {
            let _ = writeln!(out, "robot = [0.0, 0.0, 0.0] # x, y, theta");
        }
        for joint in &self.robot.joints {
            let Source::Coordinates { q, .. } = joint.source else { continue };
            if joint.motion.configuration_size() == 1 {
                let value = number_within(self.q[q], (joint.lower[0], joint.upper[0]));
                let _ = writeln!(out, "{} = {value}", quoted(&joint.name));
            }
        }
        for object in &self.objects {
            let _ = writeln!(out, "{} = {}", object.name, pose(&object.start));
        }
        let _ = writeln!(
            out,
            "\n# Only this object's pose; where the robot then is, is free. {} is within reach at both places.\n\
             [[goal]]\nobjects = {{ {} = {} }}",
            self.grasp,
            self.objects[0].name,
            pose(&self.goal)
        );
    }
}

fn surface(face: &FoundSurface, out: &mut String) {
    let points: Vec<String> = face.points.iter().map(|p| point(*p)).collect();
    let corners: Vec<String> = (0..face.points.len()).map(|i| i.to_string()).collect();
    let _ = writeln!(
        out,
        "\n[[part.surface]] # {}\nname = {}\npoints = [{}]\npolygons = [[{}]]",
        face.reason,
        quoted(&face.name),
        points.join(", "),
        corners.join(", ")
    );
}

fn object_part(object: &ObjectText<'_>, out: &mut String) {
    let bounds: Vec<String> = object.root_bounds.iter().map(|(low, high)| list(&[*low, *high])).collect();
    let _ = writeln!(
        out,
        "\n[[part]]\nname = {}\nkind = \"object\"\n{}\nroot_bounds = [{}] # the reach of the robot",
        quoted(&object.name),
        object.source,
        bounds.join(", ")
    );
    let _ =
        writeln!(out, "\n# Handles: {}. x approaches, y is the direction in which jaws close.", object.handles_from);
    for handle in &object.handles {
        let _ = writeln!(
            out,
            "[[part.handle]] # {}\nname = {}\nlink = {}\npose = {}\nclearance = {}",
            handle.reason,
            quoted(&handle.name),
            quoted(&object.link),
            pose(&handle.link_from_handle),
            number(handle.clearance)
        );
        if handle.mask != [true; 6] {
            let _ = writeln!(out, "mask = {}", mask(handle.mask));
        }
    }
    if !object.faces.is_empty() {
        let _ = writeln!(out, "\n# Faces on which it rests: the centre of mass is above each.");
    }
    object.faces.iter().for_each(|face| surface_of(face, &object.link, out));
}

fn surface_of(face: &FoundSurface, link: &str, out: &mut String) {
    let mut text = String::new();
    surface(face, &mut text);
    let named = format!("name = {}\n", quoted(&face.name));
    let linked = format!("{named}link = {}\n", quoted(link));
    out.push_str(text.trim_start_matches('\n').replacen(&named, &linked, 1).as_str());
}
