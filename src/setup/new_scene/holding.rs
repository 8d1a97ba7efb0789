//! How objects are held: handles for each gripper, or why there is none.

use crate::setup::error::SetupError;
use crate::setup::grasps_file::read_grasps;
use crate::setup::grippers::FoundGripper;
use crate::setup::grippers::GripperKind::{Jaws, Tool};
use crate::setup::handles::{FoundHandle, HandleSettings, handles};
use crate::setup::new_scene::read_objects::Object;
use crate::setup::new_scene::request::NewScene;

/// Which handles each gripper may hold, by name, where grippers differ.
pub(super) type Ways = Option<Vec<(String, Vec<String>)>>;

/// Names of handles, each once.
pub(super) fn handle_names(object: &Object) -> Vec<&FoundHandle> {
    let mut kept: Vec<&FoundHandle> = Vec::new();
    for (_, handle) in &object.handles {
        if kept.iter().all(|other| other.name != handle.name) {
            kept.push(handle);
        }
    }
    kept
}

/// Finds the handles of all objects for all grippers. Returns, where grippers differ, which handles each may hold.
pub(super) fn hold(request: &NewScene, objects: &mut [Object], grippers: &[FoundGripper]) -> Result<Ways, SetupError> {
    // Grippers of one size share handles.
    let mut kinds: Vec<usize> = Vec::new();
    let kind_of: Vec<usize> = grippers
        .iter()
        .enumerate()
        .map(|(at, gripper)| {
            let same = kinds.iter().position(|&other| alike(&grippers[other], gripper));
            same.unwrap_or_else(|| {
                kinds.push(at);
                kinds.len() - 1
            })
        })
        .collect();
    for (number, object) in objects.iter_mut().enumerate() {
        let given = request.grasps.as_deref().filter(|_| number == 0);
        for (kind, &first) in kinds.iter().enumerate() {
            let settings = HandleSettings { seed: request.seed, ..HandleSettings::default() };
            let mut found = match given {
                Some(path) => read_grasps(path, request.grasp_axes)?,
                None => handles(&object.rigid, &grippers[first], settings),
            };
            if kinds.len() > 1 && given.is_none() {
                found.iter_mut().for_each(|handle| handle.name = format!("{}_{}", handle.name, kind + 1));
            }
            for (gripper, _) in kind_of.iter().enumerate().filter(|(_, of)| **of == kind) {
                object.handles.extend(found.iter().map(|handle| (gripper, handle.clone())));
            }
        }
        if object.handles.is_empty() {
            return Err(SetupError::NoGrasp { object: object.name.clone(), reason: why_not(object, grippers) });
        }
    }
    let table = |gripper: usize| {
        let of = |object: &Object| {
            let own = object.handles.iter().filter(|(by, _)| *by == gripper);
            own.map(|(_, handle)| format!("{}/{}", object.name, handle.name)).collect::<Vec<_>>()
        };
        (format!("robot/{}", grippers[gripper].name), objects.iter().flat_map(of).collect())
    };
    Ok((kinds.len() > 1).then(|| (0..grippers.len()).map(table).collect()))
}

/// Whether two grippers have the same size to within a millimetre.
fn alike(a: &FoundGripper, b: &FoundGripper) -> bool {
    match (a.kind, b.kind) {
        (Tool, Tool) => true,
        (Jaws { opening: o, shut: s, depth: d, tip: t }, Jaws { opening, shut, depth, tip }) => {
            [(o, opening), (s, shut), (d, depth), (t, tip)].iter().all(|(x, y)| (x - y).abs() < 1e-3)
        }
        _ => false,
    }
}

/// Why no gripper holds an object.
fn why_not(object: &Object, grippers: &[FoundGripper]) -> String {
    let (low, high) = object.rigid.bounds;
    let size = (high - low) * 1e3;
    let hand = |gripper: &FoundGripper| match gripper.kind {
        Jaws { opening, depth, .. } => {
            format!("`{}` opens {:.0} mm and takes {:.0} mm into the hand", gripper.name, opening * 1e3, depth * 1e3)
        }
        Tool => format!("`{}` finds no flat place for its tip", gripper.name),
    };
    let hands: Vec<String> = grippers.iter().map(hand).collect();
    let fits = grippers.iter().any(|gripper| match gripper.kind {
        Jaws { opening, .. } => (high - low).min_element() < opening,
        Tool => false,
    });
    let blocked = if fits { "; where it fits between the jaws, the open hand's own shapes are in the way" } else { "" };
    let scale = match size.max_element() > 3000.0 {
        true => "; are its lengths millimetres? Write \"FILE 0.001\"",
        false => "",
    };
    format!("it is {:.0} x {:.0} x {:.0} mm, and {}{scale}", size.x, size.y, size.z, hands.join(", ")) + blocked
}
