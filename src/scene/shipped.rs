//! Scenes that live in the program.

use crate::scene::assemble::load::load;
use crate::scene::assemble::names::start_file::StartFile;
use crate::scene::assemble::scene::{Scene, SceneFile, SceneOrigin};
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::program_files;
use crate::scene::sources::source::{SceneBase, sha256};

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
}

macro_rules! scene_file {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/", $name))
    };
}

const SCENES: &[ShippedScene] = &[
    ShippedScene {
        name: "demo",
        summary: "A robot with two arms swaps two boxes on a table; primitive shapes, no download",
        text: scene_file!("demo/scene.toml"),
        needs_models: false,
    },
    ShippedScene {
        name: "stack",
        summary: "The same robot stacks three boxes: objects lie on objects",
        text: scene_file!("stack/scene.toml"),
        needs_models: false,
    },
    ShippedScene {
        name: "drawer",
        summary: "A hand on a gantry opens a drawer, takes a box out, puts it on top and shuts the drawer",
        text: scene_file!("drawer/scene.toml"),
        needs_models: false,
    },
    ShippedScene {
        name: "panda-table",
        summary: "A Panda moves its hand from over a table to under it (motion planning only)",
        text: scene_file!("panda-table/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "panda-shelf",
        summary: "A Panda moves its hand from one bay of a shelf into another (motion planning only)",
        text: scene_file!("panda-shelf/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "panda-box",
        summary: "A Panda moves its hand out of one box into another (motion planning only)",
        text: scene_file!("panda-box/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "panda-cage",
        summary: "A Panda moves its hand out of one window of a cage into another (motion planning only)",
        text: scene_file!("panda-cage/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "baxter-case1",
        summary: "Baxter moves two boxes with its right arm (Table II, case 1)",
        text: scene_file!("baxter-case1/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "baxter-case2",
        summary: "Baxter swaps two boxes with its right arm (Table II, case 2)",
        text: scene_file!("baxter-case2/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "baxter-case3",
        summary: "Baxter swaps two boxes with both arms (Table II, case 3)",
        text: scene_file!("baxter-case3/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "baxter-case4",
        summary: "Baxter permutes three boxes with both arms (Table II, case 4)",
        text: scene_file!("baxter-case4/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "baxter-manipulation-boxes",
        summary: "Baxter swaps two boxes with both arms (benchmark layout of 2022-2024)",
        text: scene_file!("baxter-manipulation-boxes/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "pr2-in-iai-kitchen",
        summary: "PR2 moves both arms among the furniture of a kitchen (motion planning only)",
        text: scene_file!("pr2-in-iai-kitchen/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "hpp-tutorial-3",
        summary: "PR2 moves a box along a table with its left hand (third tutorial of HPP)",
        text: scene_file!("hpp-tutorial-3/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "pr2-manipulation-kitchen",
        summary: "PR2 drives and carries a box from a table to the counter of the sink",
        text: scene_file!("pr2-manipulation-kitchen/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "pr2-manipulation-two-hand",
        summary: "PR2 turns a box over, passing it from one hand to the other",
        text: scene_file!("pr2-manipulation-two-hand/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "ur3-spheres",
        summary: "A UR3 swaps two spheres on the ground",
        text: scene_file!("ur3-spheres/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "construction-set",
        summary: "Two UR3 put a sphere on each end of a cylinder, by magnets, and lay the assembly down",
        text: scene_file!("construction-set/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "romeo-placard",
        summary: "Romeo turns a placard about the vertical by passing it from hand to hand (Table I)",
        text: scene_file!("romeo-placard/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "talos-pass-box",
        summary: "Talos passes a small box from its left to its right hand, standing still",
        text: scene_file!("talos-pass-box/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "pyrene-on-the-ground",
        summary: "Talos moves an arm and slides over the ground with both feet, in balance",
        text: scene_file!("pyrene-on-the-ground/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "talos-steps",
        summary: "Talos walks half a metre in quasi-static steps",
        text: scene_file!("talos-steps/scene.toml"),
        needs_models: true,
    },
    ShippedScene {
        name: "romeo-fridge-upright",
        summary: "Romeo takes a cup from the sink into the fridge: it opens the door, and shuts it again",
        text: scene_file!("romeo-fridge-upright/scene.toml"),
        needs_models: true,
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
        let scene = load(&name, self.text, SceneBase::Embedded(self.name), packages, start)?;
        let file = SceneFile { origin: SceneOrigin::Shipped(self.name), sha256: sha256(self.text.as_bytes()) };
        Ok(Scene { file: Some(file), ..scene })
    }

    /// The scene file with models that any place may use: those in the program are named as of the package `foliate_scenes`, which the
    /// program holds.
    #[must_use]
    pub fn copy(&self) -> String {
        let mut text = self.text.to_owned();
        for (at, _) in self.text.rmatch_indices('"') {
            // The quotation mark that opens a name is the last one before the mark that closes it.
            let Some(start) = self.text[..at].rfind('"').map(|start| start + 1) else { continue };
            let name = &self.text[start..at];
            if !name.contains("://") && program_files::find(&program_files::below(self.name, name)).is_some() {
                text.replace_range(start..at, &program_files::url(self.name, name));
            }
        }
        text
    }
}
