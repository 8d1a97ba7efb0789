//! Reads a suite file.

use crate::batch::improvement::measurement::{Budget, Measurement};
use crate::batch::run::seeds::Seeds;
use crate::batch::run::variant::Variant;
use crate::batch::suite::definition::Suite;
use crate::batch::suite::read_vary;
use crate::scene::reading::error::{SceneError, did_you_mean, quoted};
use crate::scene::reading::input;
use crate::scene::reading::keys::{File, Item, Keys};
use crate::scene::shipped;
use crate::scene::sources::mesh_name::folder_of;
use foliate_kernels::lanes::Level;
use foliate_systems::settings::{SearchSettings, Selection};
use std::ops::RangeInclusive;
use std::path::Path;
use std::time::Duration;

/// The first line of every suite file.
const FORMAT: &str = "foliate.suite/1";
/// Most threads.
const THREADS: RangeInclusive<u64> = 1..=512;
/// Most scenes, schedulers or settings.
const MOST: usize = 1000;

impl Suite {
    /// Reads a suite file. Scenes that are not shipped are files, whose names start at the suite's folder.
    ///
    /// # Errors
    /// The first thing that is wrong, with file, line and key; keys that no suite has are wrong.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let text = input::decode(input::bytes(path, input::SCENE_CAP)?, &name)?;
        Self::from_text(&name, &text, folder_of(path))
    }

    /// Reads a suite from its text. `name` is what messages call it; relative names start at `directory`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_text(name: &str, text: &str, directory: &Path) -> Result<Self, SceneError> {
        let file = File::of_suite(name, text);
        let table = file.parse(text)?;
        let mut keys = Keys::root(&file, &table);
        let format = keys.required("format")?;
        if format.string()? != FORMAT {
            let what = format!("`{}` is no format of suites", quoted(format.string()?));
            return Err(format.error(what).hint(format!("this version reads \"{FORMAT}\"")));
        }
        let suite_name = keys.required("name")?.string()?.to_owned();
        let scenes = strings(&keys.required("scenes")?)?;
        let scenes = scenes.into_iter().map(|scene| located(scene, directory)).collect();
        let settings = settings(&mut keys)?;
        let most = settings.iter().map(|variant| variant.threads).max().unwrap_or(1);
        let suite = Self {
            name: suite_name,
            scenes,
            schedulers: schedulers(&mut keys)?,
            seeds: keys.optional("seeds").map_or_else(|| Ok(default_seeds()), |item| seeds(&item))?,
            time_limit: seconds_or(&mut keys, "time_limit", 60.0)?,
            threads: keys.optional("threads").map_or(Ok(most), |item| Ok(item.whole(THREADS)? as usize))?,
            improvement: improvement(&mut keys)?,
            vary: keys.optional("vary").map(|item| read_vary::vary(&item)).transpose()?,
            paths: keys.optional("paths").map_or(Ok(true), |item| item.boolean())?,
            settings,
        };
        keys.finish()?;
        Ok(suite)
    }
}

fn default_seeds() -> Seeds {
    Seeds::one_to(20)
}

/// A list of texts, none empty, none twice.
fn strings<'f>(item: &Item<'f>) -> Result<Vec<&'f str>, SceneError> {
    let items = item.list()?;
    if items.is_empty() || items.len() > MOST {
        return Err(item.error(format!("{} are given, 1 to {MOST} are read", items.len())));
    }
    let mut texts: Vec<&str> = Vec::with_capacity(items.len());
    for item in &items {
        let text = item.string()?;
        if texts.contains(&text) {
            return Err(item.error(format!("`{}` is given twice", quoted(text))));
        }
        texts.push(text);
    }
    Ok(texts)
}

/// A shipped scene by its name, any other by the path of its file.
fn located(scene: &str, directory: &Path) -> String {
    match shipped::find(scene) {
        Some(_) => scene.to_owned(),
        None => directory.join(scene).display().to_string(),
    }
}

fn schedulers(keys: &mut Keys<'_>) -> Result<Vec<String>, SceneError> {
    let Some(item) = keys.optional("schedulers") else { return Ok(vec![foliate_schedulers::DEFAULT.to_owned()]) };
    let known: Vec<_> = foliate_schedulers::shipped().iter().map(|scheduler| scheduler.name()).collect();
    let names = strings(&item)?;
    match names.iter().position(|name| !known.contains(name)) {
        Some(at) => {
            let error = item.list()?[at].error(format!("there is no scheduler `{}`", quoted(names[at])));
            Err(error.hint(did_you_mean(names[at], known)))
        }
        None => Ok(names.into_iter().map(str::to_owned).collect()),
    }
}

fn seeds(item: &Item<'_>) -> Result<Seeds, SceneError> {
    if item.is_string() {
        return item.string()?.parse().map_err(|error| item.error(format!("{error}")));
    }
    let seed = item.whole(0..=u64::from(u32::MAX))?;
    Seeds::new(seed, seed).ok_or_else(|| item.error("is no seed"))
}

fn seconds(item: &Item<'_>) -> Result<Duration, SceneError> {
    let number = item.distance()?;
    Duration::try_from_secs_f64(number).map_err(|error| item.error(format!("{error}")))
}

fn seconds_or(keys: &mut Keys<'_>, key: &'static str, otherwise: f64) -> Result<Duration, SceneError> {
    keys.optional(key).map_or_else(|| Ok(Duration::from_secs_f64(otherwise)), |item| seconds(&item))
}

fn improvement(keys: &mut Keys<'_>) -> Result<Option<Measurement>, SceneError> {
    let (work, time, checkpoints) =
        (keys.optional("improve_work"), keys.optional("improve_time"), keys.optional("checkpoints"));
    let budget = match (work, time) {
        (Some(_), Some(time)) => return Err(time.error("says how much is improved a second time")),
        (Some(work), None) => Budget::Work(work.whole(0..=1 << 53)?),
        (None, Some(time)) => Budget::Time(seconds(&time)?),
        (None, None) => {
            return match checkpoints {
                Some(item) => Err(item.error("nothing is improved").hint("give `improve_work` or `improve_time`")),
                None => Ok(None),
            };
        }
    };
    let measurement = Measurement::new(budget);
    let Some(item) = checkpoints else { return Ok(Some(measurement)) };
    let times = item.list()?.iter().map(seconds).collect::<Result<Vec<_>, _>>()?;
    Ok(Some(measurement.checkpoints(times)))
}

fn settings(keys: &mut Keys<'_>) -> Result<Vec<Variant>, SceneError> {
    let Some(item) = keys.optional("settings") else {
        return Ok(vec![Variant::new("", SearchSettings::default())]);
    };
    let items = item.list()?;
    if items.is_empty() || items.len() > MOST {
        return Err(item.error(format!("{} are given, 1 to {MOST} are read", items.len())));
    }
    items.iter().map(variant).collect()
}

fn variant(item: &Item<'_>) -> Result<Variant, SceneError> {
    let mut keys = item.keys()?;
    let name = keys.required("name")?;
    let text = name.string()?;
    if text.len() > 64 || !text.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)) {
        return Err(name.error("has other characters than letters, digits, `_`, `-` and `.`, or more than 64"));
    }
    let mut search = SearchSettings::default();
    if let Some(item) = keys.optional("candidates") {
        search.candidates = item.whole(1..=4096)? as usize;
    }
    if let Some(item) = keys.optional("max_steps") {
        search.max_steps = item.whole(0..=1 << 53)?;
    }
    if let Some(item) = keys.optional("loop_weight") {
        search.loop_weight = item.distance()?;
    }
    if let Some(item) = keys.optional("selection") {
        search.selection = selection(&item)?;
    }
    if let Some(item) = keys.optional("simd") {
        search.level = Level::named(item.string()?).map_err(|error| item.error(error.to_string()))?;
    }
    let threads = keys.optional("threads").map_or(Ok(1), |item| item.whole(THREADS))? as usize;
    keys.finish()?;
    Ok(Variant { threads, ..Variant::new(text, search) })
}

fn selection(item: &Item<'_>) -> Result<Selection, SceneError> {
    let rules = [
        ("guided", Selection::Guided),
        ("leaf-first", Selection::LeafFirst),
        ("state-first", Selection::StateFirst),
        ("nearest", Selection::Nearest),
    ];
    let text = item.string()?;
    let rule = rules.iter().find(|(name, _)| *name == text).map(|(_, rule)| *rule);
    let names = rules.map(|(name, _)| name);
    rule.ok_or_else(|| item.error(format!("`{}` is no rule", quoted(text))).hint(did_you_mean(text, names)))
}
