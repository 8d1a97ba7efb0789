//! How objects are held: handles for each gripper, or why there is none.

use crate::setup::error::SetupError;
use crate::setup::grasps_file::read_grasps;
use crate::setup::grippers::FoundGripper;
use crate::setup::handles::{HandleSettings, Kinds, handles, no_grasp};
use crate::setup::new_scene::read_objects::Object;
use crate::setup::new_scene::request::NewScene;

/// Which handles each gripper may hold, by name, where grippers differ.
pub(super) type Ways = Option<Vec<(String, Vec<String>)>>;

/// Finds the handles of all objects for all grippers. Returns, where grippers differ, which handles each may hold.
pub(super) fn hold(request: &NewScene, objects: &mut [Object], grippers: &[FoundGripper]) -> Result<Ways, SetupError> {
    let kinds = Kinds::of(grippers);
    let settings = HandleSettings { seed: request.seed, ..HandleSettings::default() };
    for (number, object) in objects.iter_mut().enumerate() {
        object.handles = match request.grasps.as_deref().filter(|_| number == 0) {
            // Grasps of others are for any gripper.
            Some(path) => {
                let given = read_grasps(path, request.grasp_axes)?;
                (0..grippers.len())
                    .flat_map(|gripper| given.iter().map(move |handle| (gripper, handle.clone())))
                    .collect()
            }
            None => {
                kinds.handles(|gripper| Ok::<_, SetupError>(handles(&object.rigid, &grippers[gripper], settings)))?
            }
        };
        if object.handles.is_empty() {
            return Err(no_grasp(&object.rigid, grippers));
        }
    }
    let table = |gripper: usize| {
        let of = |object: &Object| {
            let own = object.handles.iter().filter(|(by, _)| *by == gripper);
            own.map(|(_, handle)| format!("{}/{}", object.name, handle.name)).collect::<Vec<_>>()
        };
        (format!("robot/{}", grippers[gripper].name), objects.iter().flat_map(of).collect())
    };
    Ok(kinds.differ().then(|| (0..grippers.len()).map(table).collect()))
}
