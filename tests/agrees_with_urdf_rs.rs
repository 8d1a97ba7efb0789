//! Foliate's reader of URDF files against the crate `urdf-rs`, on every published robot: both make the same model.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so")]

mod common;

use foliate::components::robot::model::{JointKind, JointModel, LinkModel};
use foliate::components::robot::shape::Geometry;
use foliate::scene::{PackagePath, ReadModel, UpAxis, read_model};
use foliate::urdf_rs;
use std::path::Path;

/// What differs between two models, in words.
fn differences(ours: &ReadModel, theirs: &ReadModel, capsules: bool) -> Vec<String> {
    let mut found = Vec::new();
    let mut same = |what: &str, equal: bool| {
        if !equal {
            found.push(what.to_owned());
        }
    };
    let (ours, theirs) = (&ours.model, &theirs.model);
    same("the name", ours.name == theirs.name);
    same("the number of links", ours.links.len() == theirs.links.len());
    same("the number of joints", ours.joints.len() == theirs.joints.len());
    for (one, other) in ours.links.iter().zip(&theirs.links) {
        same(&format!("link {}", one.name), one.name == other.name && same_link(one, other, capsules));
    }
    for (one, other) in ours.joints.iter().zip(&theirs.joints) {
        same(&format!("joint {}: {one:?} and {other:?}", one.name), same_joint(one, other));
    }
    found
}

fn same_link(one: &LinkModel, other: &LinkModel, capsules: bool) -> bool {
    // A mass of zero says as little as none.
    let inertial = |link: &LinkModel| link.inertial.filter(|inertial| inertial.mass > 0.0);
    let shapes = one.shapes.iter().zip(&other.shapes);
    inertial(one) == inertial(other)
        && one.shapes.len() == other.shapes.len()
        && shapes
            .into_iter()
            .all(|((pose, one), (their_pose, other))| pose == their_pose && same_solid(one, other, capsules))
}

fn same_solid(one: &Geometry, other: &Geometry, capsules: bool) -> bool {
    match (one, other) {
        (Geometry::Mesh(one), Geometry::Mesh(other)) => {
            one.vertices == other.vertices && one.triangles == other.triangles && one.closed == other.closed
        }
        // `urdf-rs` does not know the element that makes capsules of cylinders.
        (
            Geometry::Capsule { radius, half_length },
            Geometry::Cylinder { radius: theirs, half_length: their_half_length },
        ) => capsules && (radius, half_length) == (theirs, their_half_length),
        // Solids without vertices are few numbers, and these are written whole.
        (one, other) => format!("{one:?}") == format!("{other:?}"),
    }
}

fn same_joint(one: &JointModel, other: &JointModel) -> bool {
    let moves = one.kind != JointKind::Fixed;
    // Without `<limit>` a file gives no velocity, and `urdf-rs` gives zero.
    let velocity = |joint: &JointModel| joint.velocity_limit.filter(|&v| moves && v > 0.0);
    (&one.name, one.kind, one.parent, one.child) == (&other.name, other.kind, other.parent, other.child)
        && one.parent_from_joint == other.parent_from_joint
        && one.axis == other.axis
        && one.limits == other.limits
        && one.mimic == other.mimic
        && velocity(one) == velocity(other)
}

fn parsed(urdf: &Path, packages: &PackagePath) -> Result<ReadModel, String> {
    let robot = urdf_rs::read_from_string(&std::fs::read_to_string(urdf).unwrap()).map_err(|e| e.to_string())?;
    ReadModel::from_urdf_rs(&robot, urdf.parent().unwrap(), UpAxis::AsWritten, packages).map_err(|e| e.to_string())
}

#[test]
fn both_read_every_published_robot_alike() {
    let Some(packages) = common::published_models("both_read_every_published_robot_alike") else { return };
    let (mut compared, mut only_ours, mut different) = (0, Vec::new(), Vec::new());
    for package in common::PACKAGES {
        for urdf in common::files_below(&packages.find(package).unwrap(), ".urdf") {
            let name = urdf.display().to_string();
            // What neither can read is the concern of other tests.
            let Ok(mut ours) = read_model(&name, None, UpAxis::AsWritten, &packages) else { continue };
            match parsed(&urdf, &packages) {
                Err(why) => only_ours.push(format!("{name}: {why}")),
                Ok(mut theirs) => {
                    compared += 1;
                    let capsules = std::fs::read_to_string(&urdf).unwrap().contains("<collision_checking");
                    different.extend(
                        differences(&ours, &theirs, capsules).into_iter().map(|what| format!("{name}: {what}")),
                    );
                    assert_eq!(ours.sha256.keys().filter(|k| *k != "urdf").count(), theirs.sha256.len(), "{name}");
                    if let (Ok(ours), Ok(theirs)) = (ours.compose_alone(), theirs.compose_alone()) {
                        assert_eq!(ours.space.size(), theirs.space.size(), "{name}");
                    }
                }
            }
        }
    }
    assert!(different.is_empty(), "{different:#?}");
    println!("{compared} models are read alike; {} only by Foliate: {only_ours:#?}", only_ours.len());
    assert!(compared > 50 && only_ours.len() * 4 < compared, "{compared} compared; {only_ours:#?}");
}

#[test]
fn what_makes_no_model_is_refused_by_its_name() {
    let refused = |text: &str| {
        let robot = urdf_rs::read_from_string(text).unwrap();
        ReadModel::from_urdf_rs(&robot, ".", UpAxis::AsWritten, &PackagePath::only(&[])).unwrap_err().to_string()
    };
    let link = |name: &str| format!("<link name=\"{name}\"/>");
    let joint = |parts: &str| {
        format!(
            "<robot name=\"r\">{}{}<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>{parts}</joint></robot>",
            link("a"),
            link("b")
        )
    };
    let cases = [
        (format!("<robot name=\"r\">{}{}</robot>", link("a"), link("a")), "<link name=\"a\">: a link of this name"),
        (joint("<limit lower=\"1\" upper=\"0\" velocity=\"1\" effort=\"1\"/>"), "<joint name=\"j\">: [1, 0] are no limits"),
        (
            joint("<axis xyz=\"0 0 0\"/><limit lower=\"0\" upper=\"1\" velocity=\"1\" effort=\"1\"/>"),
            "<joint name=\"j\">: an axis has a length",
        ),
        (joint("").replace("child link=\"b\"", "child link=\"c\""), "<joint name=\"j\">: link `c` does not exist"),
        (
            "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"absent.stl\"/></geometry></collision></link></robot>"
                .into(),
            "absent.stl",
        ),
    ];
    for (text, words) in cases {
        let error = refused(&text);
        assert!(error.contains(words) && error.starts_with("urdf_rs::Robot: "), "{error}");
    }
}
