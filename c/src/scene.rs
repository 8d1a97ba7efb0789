//! Scenes: what is planned for.

use crate::arguments::{array, folders, reference, target, text};
use crate::error::{Failure, FoliateStatus, status_of};
use foliate::prelude::{CoordinateValue, PackagePath, Scene};
use foliate::systems::planning_model::{Model, PlanningModel};
use std::ffi::c_char;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// A scene. Calls that only read it may come from several threads at once.
pub struct FoliateScene {
    pub(crate) scene: Scene,
    model: OnceLock<PlanningModel>,
}

impl FoliateScene {
    fn of(scene: Scene) -> Self {
        Self { scene, model: OnceLock::new() }
    }

    /// The constraint graph and the tables, made once.
    pub(crate) fn model(&self) -> Result<PlanningModel, Failure> {
        if let Some(model) = self.model.get() {
            return Ok(model.clone());
        }
        let model = Model::new(self.scene.problem.clone());
        let model = model.map_err(|why| Failure::new(FoliateStatus::Unreadable, why))?;
        Ok(self.model.get_or_init(|| PlanningModel(Arc::new(model))).clone())
    }

    /// What is changed here is no scene file any more.
    fn changed(&mut self) -> &mut Scene {
        self.model = OnceLock::new();
        (self.scene.file, self.scene.start) = (None, None);
        &mut self.scene
    }
}

/// Loads a scene: a shipped one by its name (`demo`), or a file. `packages` are folders in which `package://` names are looked up.
///
/// # Safety
/// `name` is a text; `packages` has `package_count` texts; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_scene_load(
    name: *const c_char,
    packages: *const *const c_char,
    package_count: usize,
    out: *mut *mut FoliateScene,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (name, packages, out) =
            unsafe { (text(name, "name")?, folders(packages, package_count)?, target(out, "out")?) };
        let scene = Scene::load(name, &PackagePath::from_environment(&packages));
        let scene = scene.map_err(|why| Failure::new(FoliateStatus::Unreadable, why))?;
        *out = Box::into_raw(Box::new(FoliateScene::of(scene)));
        Ok(())
    })
}

/// Reads a scene from the text of a scene file. Names of files in it start at `folder`.
///
/// # Safety
/// `toml` and `folder` are texts; `packages` has `package_count` texts; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_scene_from_text(
    toml: *const c_char,
    folder: *const c_char,
    packages: *const *const c_char,
    package_count: usize,
    out: *mut *mut FoliateScene,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (toml, folder) = unsafe { (text(toml, "toml")?, text(folder, "folder")?) };
        // SAFETY: the caller's promise.
        let (packages, out) = unsafe { (folders(packages, package_count)?, target(out, "out")?) };
        let scene = Scene::from_text("scene", toml, Path::new(folder), &PackagePath::from_environment(&packages));
        let scene = scene.map_err(|why| Failure::new(FoliateStatus::Unreadable, why))?;
        *out = Box::into_raw(Box::new(FoliateScene::of(scene)));
        Ok(())
    })
}

/// Frees a scene. Null is nothing to free.
///
/// # Safety
/// `scene` is null or came from this interface, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_scene_free(scene: *mut FoliateScene) {
    if !scene.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { Box::from_raw(scene) });
    }
}

/// Sets where a joint (`part/joint`) or a part starts. A joint has one number (rad or m), a base on the floor three (x, y, angle), a part seven: x, y, z in metres and the quaternion x, y, z, w,
/// in the world.
///
/// # Safety
/// `scene` came from this interface and is not used elsewhere during the call; `name` is a text; `values` has `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_scene_set_start(
    scene: *mut FoliateScene,
    name: *const c_char,
    values: *const f64,
    count: usize,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (scene, name, values) =
            unsafe { (target(scene, "scene")?, text(name, "name")?, array(values, count, "values")?) };
        let value = value(name, values)?;
        scene.changed().problem.set_start(name, value).map_err(Failure::argument)
    })
}

/// Sets the goal: each of `count` joints or parts has its values in the end, as in `foliate_scene_set_start`. What is not named is free, but nothing stays in a hand. Goals that the scene had are gone.
///
/// # Safety
/// `scene` as in `foliate_scene_set_start`; `names` has `count` texts, `values` as many arrays, `value_counts` how many numbers each of them has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_scene_set_goal(
    scene: *mut FoliateScene,
    names: *const *const c_char,
    values: *const *const f64,
    value_counts: *const usize,
    count: usize,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let scene = unsafe { target(scene, "scene") }?;
        // SAFETY: the caller's promise.
        let (names, values) = unsafe { (array(names, count, "names")?, array(values, count, "values")?) };
        // SAFETY: the caller's promise.
        let counts = unsafe { array(value_counts, count, "value_counts") }?;
        let mut wanted: Vec<(&str, CoordinateValue)> = Vec::with_capacity(count);
        for ((&name, &numbers), &count) in names.iter().zip(values).zip(counts) {
            // SAFETY: the caller's promise.
            let (name, numbers) = unsafe { (text(name, "names")?, array(numbers, count, "values")?) };
            wanted.push((name, value(name, numbers)?));
        }
        let goal = scene.scene.problem.partial_goal(wanted).map_err(Failure::argument)?;
        scene.changed().problem.goals = vec![goal];
        Ok(())
    })
}

/// What a joint or part has at the start, into `values`, which has room for `capacity` numbers; `count` becomes how many there are.
///
/// # Safety
/// `scene` came from this interface; `name` is a text; `values` has room for `capacity` numbers; `count` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foliate_scene_start(
    scene: *const FoliateScene,
    name: *const c_char,
    values: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> FoliateStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (scene, name, count) =
            unsafe { (reference(scene, "scene")?, text(name, "name")?, target(count, "count")?) };
        let problem = &scene.scene.problem;
        let numbers = problem.robot.get(&problem.start, name).map_err(Failure::argument)?.numbers();
        *count = numbers.len();
        if numbers.len() > capacity || values.is_null() {
            return Err(Failure::argument(format!(
                "`{name}` has {} numbers, and there is room for {capacity}",
                numbers.len()
            )));
        }
        // SAFETY: not null, with room for them.
        unsafe { std::ptr::copy_nonoverlapping(numbers.as_ptr(), values, numbers.len()) };
        Ok(())
    })
}

fn value(name: &str, numbers: &[f64]) -> Result<CoordinateValue, Failure> {
    CoordinateValue::from_numbers(numbers).ok_or_else(|| {
        Failure::argument(format!(
            "`{name}` has {} numbers; a joint has one, a base on the floor three (x, y, angle), a part seven (x, y, z, and the quaternion x, y, z, w)",
            numbers.len()
        ))
    })
}
