//! Instances of a problem, each by its number.

use crate::batch::entry::Entry;
use crate::batch::vary::edit;
use crate::batch::vary::options::{Vary, Which};
use crate::batch::vary::places::Places;
use crate::batch::vary::rejections::{Rejection, Rejections};
use crate::planner::solving::Planner;
use crate::scene::assemble::load;
use crate::scene::assemble::scene::{Scene, SceneOrigin};
use crate::scene::reading::error::{SceneError, did_you_mean};
use crate::scene::reading::input;
use crate::scene::shipped;
use crate::scene::sources::mesh_name::folder_of;
use crate::scene::sources::package::PackagePath;
use crate::scene::sources::source::{SceneBase, sha256};
use foliate_components::robot::{PartKind, Robot, RootJoint};
use foliate_systems::planning_model::{Model, ModelError, PlanningModel, ProblemTables};
use foliate_systems::runtime::random::{Purpose, stream};
use foliate_systems::settings::SearchSettings;
use rand::RngExt;
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use toml::{Table, Value};

/// Random streams of instances.
const INSTANCE: Purpose = Purpose::of_host(0x7661_7279);

/// A problem and how its instances differ from it.
#[derive(Clone, Debug)]
pub struct Variations {
    vary: Vary,
    name: String,
    model: PlanningModel,
    scene: Option<Scene>,
    /// Where the scene itself varies.
    text: Option<SceneText>,
    settings: SearchSettings,
}

/// A scene file that is changed and read again.
#[derive(Clone, Debug)]
struct SceneText {
    name: String,
    table: Table,
    base: SceneBase,
    packages: PackagePath,
}

/// A varied problem.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its number.
    pub number: u64,
    /// The problem, and what follows from it.
    pub tables: Arc<ProblemTables>,
    /// What files say besides the problem, where it comes from a scene. No file says what it is.
    pub scene: Option<Scene>,
    /// The text of the changed scene, where the scene itself varies. Its start and goals are those before the places were drawn.
    pub text: Option<String>,
    /// Draws before this one, by the reason why they were none.
    pub refused: Rejections,
}

/// Why there is no instance of a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoInstance {
    /// The number.
    pub number: u64,
    /// Draws that were tried.
    pub tries: u32,
    /// Why they were none.
    pub refused: Rejections,
    /// What the last scene that could not be read was refused with.
    pub why: Option<String>,
}

impl fmt::Display for NoInstance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "none of {} draws is an instance: {}", self.tries, self.refused.words())?;
        self.why.as_ref().map_or(Ok(()), |why| write!(f, "; {why}"))
    }
}

impl std::error::Error for NoInstance {}

impl Instance {
    /// A planner for it.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn planner(&self) -> Result<Planner, ModelError> {
        Planner::from_tables(Arc::clone(&self.tables))
    }
}

impl Variations {
    /// Prepares to vary a problem. Models of scenes that vary themselves are looked for by `packages`.
    ///
    /// # Errors
    /// Numbers that cannot be, parts that the problem does not have or that cannot vary so, and a scene whose text is not there: one that
    /// was made in code, or whose file has changed since it was read.
    pub fn new(entry: &Entry, vary: Vary, packages: &PackagePath) -> Result<Self, SceneError> {
        let name = entry.name().to_owned();
        if let Some((key, what)) = vary.fault() {
            return Err(SceneError::new(name, key, what));
        }
        let text = if vary.changes_scene() { Some(SceneText::of(entry, packages)?) } else { None };
        let model = entry.model().clone();
        let variations =
            Self { vary, name, model, scene: entry.scene().cloned(), text, settings: SearchSettings::default() };
        variations.check_names()?;
        Ok(variations)
    }

    /// How instances vary.
    #[must_use]
    pub fn vary(&self) -> &Vary {
        &self.vary
    }

    fn check_names(&self) -> Result<(), SceneError> {
        let robot = &self.model.problem.robot;
        let unknown = |key: &str, part: &str, what: &str, known: Vec<&str>| {
            let error = SceneError::new(&self.name, key, format!("`{}` is {what}", part.escape_debug()));
            error.hint(did_you_mean(part, known))
        };
        for (key, which) in [("vary.starts", &self.vary.starts), ("vary.goals", &self.vary.goals)] {
            let Which::These(names) = which else { continue };
            let known = self.lying();
            if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
                return Err(unknown(key, name, "no object that lies on a support fixed in the world", known));
            }
        }
        let movable = edit::movable(robot);
        if let Some((_, most)) = self.vary.objects.filter(|(_, most)| *most > movable.len()) {
            let what = format!("is up to {most}, the scene has {} movable objects", movable.len());
            return Err(SceneError::new(&self.name, "vary.objects", what));
        }
        let fixed: Vec<&str> = fixed_parts(robot);
        if let Some(moved) = self.vary.moves.iter().find(|moved| !fixed.contains(&moved.part.as_str())) {
            return Err(unknown("vary.move", &moved.part, "no part that is fixed in the world", fixed));
        }
        let shaped = self.text.as_ref().map(|text| shaped_parts(&text.table)).unwrap_or_default();
        match self.vary.sizes.iter().find(|size| !shaped.contains(&size.part.as_str())) {
            Some(size) => Err(unknown("vary.size", &size.part, "no part with a `shape`", shaped)),
            None => Ok(()),
        }
    }

    /// Objects that may lie on what is fixed in the world.
    fn lying(&self) -> Vec<&str> {
        let objects = self.model.graph.objects.iter().zip(self.model.objects());
        let lying = objects.filter(|(_, object)| object.root.is_some() && object.placement_on(None).is_some());
        lying.map(|(options, _)| self.model.problem.robot[options.part].name.as_str()).collect()
    }

    /// The instance of a number. It depends on that and the seed alone.
    ///
    /// # Errors
    /// None of the draws has start and goals that could be planned for.
    pub fn instance(&self, number: u64) -> Result<Instance, NoInstance> {
        let (mut refused, mut why) = (Rejections::default(), None);
        for attempt in 0..self.vary.tries {
            let mut rng = stream(self.vary.seed, INSTANCE, number, attempt);
            match self.draw(number, &mut rng, &mut refused) {
                Ok(Some(instance)) => return Ok(Instance { refused, ..instance }),
                Ok(None) => {}
                Err(error) => {
                    refused.add(Rejection::Scene);
                    why = Some(error);
                }
            }
        }
        Err(NoInstance { number, tries: self.vary.tries, refused, why })
    }

    /// One draw; the error says why the changed scene makes no problem.
    fn draw(&self, number: u64, rng: &mut impl RngExt, refused: &mut Rejections) -> Result<Option<Instance>, String> {
        let (model, mut scene, text) = match &self.text {
            None => (self.model.clone(), self.scene.clone(), None),
            Some(text) => {
                let (scene, written) = text.draw(&self.model.problem.robot, &self.vary, rng)?;
                let model = Model::new(scene.problem.clone()).map_err(|error| error.to_string())?;
                (PlanningModel(Arc::new(model)), Some(scene), Some(written))
            }
        };
        let places = Places { model: &model, settings: &self.settings, vary: &self.vary };
        let Some(ends) = places.draw(rng, refused) else { return Ok(None) };
        let tables = Arc::new(model.tables().with_ends(ends.start, ends.goals));
        if let Some(scene) = &mut scene {
            (scene.problem.start, scene.problem.goals) = (tables.problem.start.clone(), tables.problem.goals.clone());
            (scene.file, scene.start) = (None, None);
        }
        Ok(Some(Instance { number, tables, scene, text, refused: Rejections::default() }))
    }
}

impl SceneText {
    /// The text that an entry was read from.
    fn of(entry: &Entry, packages: &PackagePath) -> Result<Self, SceneError> {
        let wrong = |what: &str| SceneError::new(entry.name(), "vary", what);
        let file = entry.scene().and_then(|scene| scene.file.as_ref());
        let file =
            file.ok_or_else(|| wrong("what is in the scene varies, and the problem comes from no scene file"))?;
        let (name, text, base) = match &file.origin {
            SceneOrigin::Shipped(name) => {
                let text = shipped::find(name).map(|scene| scene.text).unwrap_or_default();
                (format!("{name}/scene.toml"), text.to_owned(), SceneBase::Embedded(name))
            }
            SceneOrigin::File(path) => Self::read(path, &file.sha256)?,
        };
        let table = text.parse::<Table>().map_err(|error| wrong(error.message()))?;
        Ok(Self { name, table, base, packages: packages.clone() })
    }

    fn read(path: &Path, sum: &str) -> Result<(String, String, SceneBase), SceneError> {
        let (name, content) = (path.display().to_string(), input::bytes(path, input::SCENE_CAP)?);
        if sha256(&content) != sum {
            return Err(SceneError::new(name, "file", "has changed since it was read"));
        }
        let text = input::decode(content, &name)?;
        Ok((name, text, SceneBase::Directory(folder_of(path).to_owned())))
    }

    /// A changed scene, read, and its text.
    fn draw(&self, robot: &Robot, vary: &Vary, rng: &mut impl RngExt) -> Result<(Scene, String), String> {
        let text = edit::changed(&self.table, robot, vary, rng).to_string();
        let scene = load::load(&self.name, &text, self.base.clone(), &self.packages, None);
        scene.map(|scene| (scene, text)).map_err(|error| error.to_string())
    }
}

fn fixed_parts(robot: &Robot) -> Vec<&str> {
    let is_fixed = |part: &&foliate_components::robot::Part| {
        part.root == RootJoint::Fixed || (part.root == RootJoint::Planar && part.kind != PartKind::Environment)
    };
    robot.parts.iter().filter(is_fixed).map(|part| part.name.as_str()).collect()
}

fn shaped_parts(scene: &Table) -> Vec<&str> {
    let parts = scene.get("part").and_then(Value::as_array).into_iter().flatten();
    let shaped = parts.filter(|part| part.get("shape").and_then(Value::as_table).and_then(edit::size_key).is_some());
    shaped.filter_map(|part| part.get("name").and_then(Value::as_str)).collect()
}
