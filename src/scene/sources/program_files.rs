//! Models that live in the program: those of shipped scenes, by the place that they have in the folder `scenes`.
//!
//! A shipped scene names them relative to itself. Any other scene names them as files of the package `foliate_scenes`.

/// What URLs of these files begin with.
pub(crate) const PACKAGE: &str = "package://foliate_scenes/";

macro_rules! scene_file {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name))
    };
}

/// Their places and contents.
const FILES: &[(&str, &str)] = &[
    ("demo/robot.urdf", scene_file!("demo/robot.urdf")),
    ("demo/robot.srdf", scene_file!("demo/robot.srdf")),
    ("demo/table.urdf", scene_file!("demo/table.urdf")),
    ("demo/table.srdf", scene_file!("demo/table.srdf")),
    ("demo/box.urdf", scene_file!("demo/box.urdf")),
    ("demo/box.srdf", scene_file!("demo/box.srdf")),
    ("stack/box.srdf", scene_file!("stack/box.srdf")),
    ("drawer/gantry.urdf", scene_file!("drawer/gantry.urdf")),
    ("drawer/gantry.srdf", scene_file!("drawer/gantry.srdf")),
    ("drawer/cabinet.urdf", scene_file!("drawer/cabinet.urdf")),
    ("drawer/cabinet.srdf", scene_file!("drawer/cabinet.srdf")),
    ("pr2-manipulation-two-hand/box.urdf", scene_file!("pr2-manipulation-two-hand/box.urdf")),
    ("pr2-manipulation-two-hand/box.srdf", scene_file!("pr2-manipulation-two-hand/box.srdf")),
    ("pr2-manipulation-kitchen/box.urdf", scene_file!("pr2-manipulation-kitchen/box.urdf")),
    ("pr2-manipulation-kitchen/box.srdf", scene_file!("pr2-manipulation-kitchen/box.srdf")),
    ("hpp-tutorial-3/box.urdf", scene_file!("hpp-tutorial-3/box.urdf")),
    ("hpp-tutorial-3/box.srdf", scene_file!("hpp-tutorial-3/box.srdf")),
    ("panda-table/table.urdf", scene_file!("panda-table/table.urdf")),
    ("panda-shelf/shelf.urdf", scene_file!("panda-shelf/shelf.urdf")),
    ("panda-box/boxes.urdf", scene_file!("panda-box/boxes.urdf")),
    ("panda-cage/cage.urdf", scene_file!("panda-cage/cage.urdf")),
];

/// The content of a file, by its place.
pub(crate) fn find(place: &str) -> Option<&'static str> {
    FILES.iter().find(|(known, _)| *known == place).map(|(_, content)| *content)
}

/// The places of all files.
pub(crate) fn places() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(place, _)| *place)
}

/// The place of a file that a shipped scene names relative to its own folder.
pub(crate) fn below(scene: &str, name: &str) -> String {
    match name.strip_prefix("../") {
        Some(name) => name.to_owned(),
        None => format!("{scene}/{name}"),
    }
}

/// The URL of a file that a shipped scene names.
pub(crate) fn url(scene: &str, name: &str) -> String {
    format!("{PACKAGE}{}", below(scene, name))
}
