//! Scenes that live in the program.

use crate::scene::assemble::load::load;
use crate::scene::assemble::names::start_file::StartFile;
use crate::scene::assemble::scene::{Scene, SceneFile, SceneOrigin};
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::source::{Embedded, SceneBase, sha256};

/// A scene that is shipped in the binary.
#[derive(Clone, Copy, Debug)]
pub struct ShippedScene {
    /// Its name.
    pub name: &'static str,
    /// One sentence about it.
    pub summary: &'static str,
    /// The scene file.
    pub text: &'static str,
    /// Whether it needs models of published packages (`foliate models --install`).
    pub needs_models: bool,
    files: Embedded,
}

macro_rules! scene_file {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name))
    };
}

/// The demo's models, by the names that its scene file uses.
const DEMO: Embedded = &[
    ("robot.urdf", scene_file!("demo/robot.urdf")),
    ("robot.srdf", scene_file!("demo/robot.srdf")),
    ("table.urdf", scene_file!("demo/table.urdf")),
    ("table.srdf", scene_file!("demo/table.srdf")),
    ("box.urdf", scene_file!("demo/box.urdf")),
    ("box.srdf", scene_file!("demo/box.srdf")),
];

/// The demo's robot and table, boxes that carry others.
const STACK: Embedded = &[
    ("../demo/robot.urdf", scene_file!("demo/robot.urdf")),
    ("../demo/robot.srdf", scene_file!("demo/robot.srdf")),
    ("../demo/table.urdf", scene_file!("demo/table.urdf")),
    ("../demo/table.srdf", scene_file!("demo/table.srdf")),
    ("../demo/box.urdf", scene_file!("demo/box.urdf")),
    ("box.srdf", scene_file!("stack/box.srdf")),
];

/// A gantry, a cabinet, the demo's box.
const DRAWER: Embedded = &[
    ("gantry.urdf", scene_file!("drawer/gantry.urdf")),
    ("gantry.srdf", scene_file!("drawer/gantry.srdf")),
    ("cabinet.urdf", scene_file!("drawer/cabinet.urdf")),
    ("cabinet.srdf", scene_file!("drawer/cabinet.srdf")),
    ("../demo/box.urdf", scene_file!("demo/box.urdf")),
    ("../demo/box.srdf", scene_file!("demo/box.srdf")),
];

/// The box of the PR2 scenes: the published package has another one under the name that the records use.
const TWO_HAND: Embedded = &[
    ("box.urdf", scene_file!("pr2-manipulation-two-hand/box.urdf")),
    ("box.srdf", scene_file!("pr2-manipulation-two-hand/box.srdf")),
];

/// The same.
const KITCHEN: Embedded = &[
    ("box.urdf", scene_file!("pr2-manipulation-kitchen/box.urdf")),
    ("box.srdf", scene_file!("pr2-manipulation-kitchen/box.srdf")),
];

/// The same.
const TUTORIAL: Embedded =
    &[("box.urdf", scene_file!("hpp-tutorial-3/box.urdf")), ("box.srdf", scene_file!("hpp-tutorial-3/box.srdf"))];

/// What stands in the way of the Panda.
const TABLE: Embedded = &[("table.urdf", scene_file!("panda-table/table.urdf"))];

/// The same.
const SHELF: Embedded = &[("shelf.urdf", scene_file!("panda-shelf/shelf.urdf"))];

/// The same.
const BOXES: Embedded = &[("boxes.urdf", scene_file!("panda-box/boxes.urdf"))];

/// The same.
const CAGE: Embedded = &[("cage.urdf", scene_file!("panda-cage/cage.urdf"))];

const SCENES: &[ShippedScene] = &[
    ShippedScene {
        name: "demo",
        summary: "A robot with two arms swaps two boxes on a table; primitive shapes, no download",
        text: scene_file!("demo/scene.toml"),
        needs_models: false,
        files: DEMO,
    },
    ShippedScene {
        name: "stack",
        summary: "The same robot stacks three boxes: objects lie on objects",
        text: scene_file!("stack/scene.toml"),
        needs_models: false,
        files: STACK,
    },
    ShippedScene {
        name: "drawer",
        summary: "A hand on a gantry opens a drawer, takes a box out, puts it on top and shuts the drawer",
        text: scene_file!("drawer/scene.toml"),
        needs_models: false,
        files: DRAWER,
    },
    ShippedScene {
        name: "panda-table",
        summary: "A Panda moves its hand from over a table to under it (motion planning only)",
        text: scene_file!("panda-table/scene.toml"),
        needs_models: true,
        files: TABLE,
    },
    ShippedScene {
        name: "panda-shelf",
        summary: "A Panda moves its hand from one bay of a shelf into another (motion planning only)",
        text: scene_file!("panda-shelf/scene.toml"),
        needs_models: true,
        files: SHELF,
    },
    ShippedScene {
        name: "panda-box",
        summary: "A Panda moves its hand out of one box into another (motion planning only)",
        text: scene_file!("panda-box/scene.toml"),
        needs_models: true,
        files: BOXES,
    },
    ShippedScene {
        name: "panda-cage",
        summary: "A Panda moves its hand out of one window of a cage into another (motion planning only)",
        text: scene_file!("panda-cage/scene.toml"),
        needs_models: true,
        files: CAGE,
    },
    ShippedScene {
        name: "baxter-case1",
        summary: "Baxter moves two boxes with its right arm (Table II, case 1)",
        text: scene_file!("baxter-case1/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "baxter-case2",
        summary: "Baxter swaps two boxes with its right arm (Table II, case 2)",
        text: scene_file!("baxter-case2/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "baxter-case3",
        summary: "Baxter swaps two boxes with both arms (Table II, case 3)",
        text: scene_file!("baxter-case3/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "baxter-case4",
        summary: "Baxter permutes three boxes with both arms (Table II, case 4)",
        text: scene_file!("baxter-case4/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "baxter-manipulation-boxes",
        summary: "Baxter swaps two boxes with both arms (benchmark layout of 2022-2024)",
        text: scene_file!("baxter-manipulation-boxes/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "pr2-in-iai-kitchen",
        summary: "PR2 moves both arms among the furniture of a kitchen (motion planning only)",
        text: scene_file!("pr2-in-iai-kitchen/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "hpp-tutorial-3",
        summary: "PR2 moves a box along a table with its left hand (third tutorial of HPP)",
        text: scene_file!("hpp-tutorial-3/scene.toml"),
        needs_models: true,
        files: TUTORIAL,
    },
    ShippedScene {
        name: "pr2-manipulation-kitchen",
        summary: "PR2 drives and carries a box from a table to the counter of the sink",
        text: scene_file!("pr2-manipulation-kitchen/scene.toml"),
        needs_models: true,
        files: KITCHEN,
    },
    ShippedScene {
        name: "pr2-manipulation-two-hand",
        summary: "PR2 turns a box over, passing it from one hand to the other",
        text: scene_file!("pr2-manipulation-two-hand/scene.toml"),
        needs_models: true,
        files: TWO_HAND,
    },
    ShippedScene {
        name: "ur3-spheres",
        summary: "A UR3 swaps two spheres on the ground",
        text: scene_file!("ur3-spheres/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "construction-set",
        summary: "Two UR3 put a sphere on each end of a cylinder, by magnets, and lay the assembly down",
        text: scene_file!("construction-set/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "romeo-placard",
        summary: "Romeo turns a placard about the vertical by passing it from hand to hand (Table I)",
        text: scene_file!("romeo-placard/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "talos-pass-box",
        summary: "Talos passes a small box from its left to its right hand, standing still",
        text: scene_file!("talos-pass-box/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "pyrene-on-the-ground",
        summary: "Talos moves an arm and slides over the ground with both feet, in balance",
        text: scene_file!("pyrene-on-the-ground/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "talos-steps",
        summary: "Talos walks half a metre in quasi-static steps",
        text: scene_file!("talos-steps/scene.toml"),
        needs_models: true,
        files: &[],
    },
    ShippedScene {
        name: "romeo-fridge-upright",
        summary: "Romeo takes a cup from the sink into the fridge: it opens the door, and shuts it again",
        text: scene_file!("romeo-fridge-upright/scene.toml"),
        needs_models: true,
        files: &[],
    },
];

/// The scenes that are shipped, simplest first.
#[must_use]
pub fn shipped_scenes() -> &'static [ShippedScene] {
    SCENES
}

/// The shipped scene of that name.
pub(crate) fn find(name: &str) -> Option<&'static ShippedScene> {
    SCENES.iter().find(|s| s.name == name)
}

impl ShippedScene {
    /// Loads the scene.
    ///
    /// # Errors
    /// Where its models are not found or differ.
    pub fn load(&self, packages: &PackagePath) -> Result<Scene, SceneError> {
        self.load_from(packages, None)
    }

    /// Loads the scene, to start where another file says.
    ///
    /// # Errors
    /// As [`Self::load`], and what is wrong with that file.
    pub fn load_from(&self, packages: &PackagePath, start: Option<&StartFile>) -> Result<Scene, SceneError> {
        let name = format!("{}/scene.toml", self.name);
        let scene = load(&name, self.text, SceneBase::Embedded(self.files), packages, start)?;
        let file = SceneFile { origin: SceneOrigin::Shipped(self.name), sha256: sha256(self.text.as_bytes()) };
        Ok(Scene { file: Some(file), ..scene })
    }
}
