//! The page of a recorded search: its roadmap, what became of its candidates, what stood in the way, and its path where it found one.

use crate::inspection::words::ShortNames;
use crate::path_file::loaded_path::LoadedPath;
use crate::planner::recording::{FindingEntry, MisplacedEntry, Recording, ShownFunnel, ShownPair};
use crate::planner::trajectory::error::TrajectoryError;
use crate::scene::reading::error::SceneError;
use crate::scene::visuals::Visuals;
use crate::view::document::finding::WhereEntry;
use crate::view::document::graph::GraphEntry;
use crate::view::document::page::{Document, PageKind};
use crate::view::document::search::{FunnelEntry, FunnelPairEntry, SearchEntry};
use crate::view::graph::grown::recorded;
use crate::view::graph::picture::{PictureOptions, picture};
use crate::view::html::page::Page;
use crate::view::pages::base::{ViewOptions, approach_as_in, base};
use crate::view::pages::findings::{Misplaced, Placed, Violation};
use crate::view::pages::of_path::{Told, add_motion};
use foliate_components::graph::StateId;
use foliate_components::pose::pose_from_array;
use foliate_components::robot::{Robot, ShapeIndex};
use foliate_kernels::collision::{CollisionScene, PairRule};
use std::collections::HashMap;

/// Most bytes of the configurations of nodes that a page carries.
const MOST_NODE_BYTES: usize = 8 << 20;

/// The page of a recording.
///
/// `path` is the path of the recording's path file ([`RecordingHead::path`](crate::planner::recording::RecordingHead::path)), which may have no
/// segments: it has the models.
///
/// # Errors
/// The path makes no trajectory.
pub fn page_of_recording(
    recording: &Recording,
    path: &LoadedPath,
    visuals: &Visuals,
    options: &ViewOptions,
) -> Result<Page, TrajectoryError> {
    let (head, robot) = (&recording.head, &path.robot);
    let mut page = base((&head.path.scene, PageKind::Search), robot, visuals, None, options);
    approach_as_in(&mut page, None);
    page.document.warnings.extend(path.warnings.iter().map(SceneError::to_string));
    page.tell("scheduler", &head.path.scheduler);
    page.tell("seed", head.path.seed.to_string());
    page.tell("outcome", head.outcome.replace('_', " "));
    let graph = recorded(recording);
    let short = ShortNames::of(robot, &graph);
    let collision = CollisionScene::new(robot, &PairRule { ignored: &path.ignored_pairs, ..PairRule::default() });
    if path.path.segments.is_empty() {
        let reached = head.states.iter().enumerate().filter(|(_, state)| state.nodes > 0);
        let around = reached.map(|(place, _)| StateId(place as u32)).collect();
        let options = PictureOptions { around, ..PictureOptions::default() };
        page.document.graph = Some(picture(&graph, &short, &options));
        page.document.start = head.start.as_ref().map(|q| path.in_order(q));
        page.document.goal = head.goals.first().map(|q| path.in_order(q));
    } else {
        add_motion(&mut page, &Told::of_loaded(path), &graph, &collision)?;
    }
    let places = page.document.graph.as_mut().map(|graph| name_as_recorded(graph, recording)).unwrap_or_default();
    let search = search(recording, path, (&places, &short), &mut page);
    add_findings(&mut page.document, recording, path, &collision);
    page.add_search(search);
    Ok(page)
}

/// Where the states and transitions of a recording are in the page's graph, by their places in the recording.
#[derive(Debug, Default)]
struct Places {
    states: HashMap<usize, usize>,
    transitions: HashMap<usize, usize>,
}

/// Gives a picture of the recorded graph the numbers and counts of the recording.
fn name_as_recorded(graph: &mut GraphEntry, recording: &Recording) -> Places {
    let (head, mut places) = (&recording.head, Places::default());
    for (place, state) in graph.states.iter_mut().enumerate() {
        places.states.insert(state.id as usize, place);
        state.id = head.states[state.id as usize].id;
    }
    for (place, transition) in graph.transitions.iter_mut().enumerate() {
        let row = &head.transitions[transition.id as usize];
        places.transitions.insert(transition.id as usize, place);
        transition.id = row.id;
        transition.waypoints.clone_from(&row.waypoints);
    }
    for row in &head.funnel {
        if let Some(&place) = places.transitions.get(&(row.transition as usize)) {
            let transition = &mut graph.transitions[place];
            (transition.tried, transition.succeeded) = (Some(row.tried), Some(row.reached));
        }
    }
    places
}

fn search(
    recording: &Recording,
    path: &LoadedPath,
    (places, short): (&Places, &ShortNames),
    page: &mut Page,
) -> SearchEntry {
    let shown = recording.shown();
    let size = path.robot.space.size();
    let most = MOST_NODE_BYTES / (4 * size.max(1));
    let count = shown.step.len().min(most);
    let mut words = shown.words.clone();
    if count < shown.step.len() {
        words.push(format!("The page shows the first {count} of {} recorded configurations.", shown.step.len()));
    }
    let width = recording.head.path.coordinates.len();
    let in_order = |row: &[f32]| path.in_order(row);
    let rows: Vec<Vec<f32>> = shown.configurations.chunks_exact(width.max(1)).take(count).map(in_order).collect();
    // What is not proved joins nothing.
    let is_shown =
        |&edge: &usize| shown.edge_kind[edge] == 0 && shown.edges[edge].iter().all(|&n| (n as usize) < count);
    let edges: Vec<usize> = (0..shown.edges.len()).filter(is_shown).collect();
    let state = |&state: &u16| places.states.get(&usize::from(state)).map_or(u16::MAX, |&place| place as u16);
    let blob = &mut page.blob;
    SearchEntry {
        nodes: blob.floats(rows.into_iter().flatten()),
        count,
        tree: blob.shorts(shown.tree.iter().copied().take(count)),
        state: blob.shorts(shown.state.iter().map(state).take(count)),
        step: blob.words(shown.step.iter().copied().take(count)),
        edges: blob.words(edges.iter().flat_map(|&edge| shown.edges[edge])),
        edge_step: blob.words(edges.iter().map(|&edge| shown.edge_step[edge])),
        edge_count: edges.len(),
        trees: shown.trees.clone(),
        outcome: shown.outcome.clone(),
        words,
        funnel: shown.funnel.iter().map(|row| funnel_row(row, path, (places, short))).collect(),
    }
}

fn funnel_row(row: &ShownFunnel, path: &LoadedPath, (places, short): (&Places, &ShortNames)) -> FunnelEntry {
    let link = |name: &String| path.robot.link(name).map(|link| link.at());
    let pair = |pair: &ShownPair| {
        let links = [link(&pair.links[0])?, link(&pair.links[1])?];
        let configuration = pair.configuration.as_ref().map(|q| path.in_order(q));
        Some(FunnelPairEntry { links, count: pair.count, configuration })
    };
    FunnelEntry {
        transition: places.transitions.get(&row.transition).copied(),
        words: short.transition(&row.name),
        tried: row.tried,
        projected: row.projected,
        free: row.free,
        reached: row.reached,
        pairs: row.pairs.iter().filter_map(pair).collect(),
    }
}

/// Adds what is wrong with the start or the goal.
fn add_findings(document: &mut Document, recording: &Recording, path: &LoadedPath, collision: &CollisionScene) {
    for finding in &recording.head.findings {
        let (name, q) = match finding.at.as_str() {
            "start" => ("start", &document.start),
            _ => ("goal", &document.goal),
        };
        let q = q.clone().unwrap_or_else(|| document.neutral.clone());
        let placed = Placed::new(&path.robot, collision, &q, WhereEntry::Named(name));
        match shapes(&path.robot, finding).and_then(|pair| placed.collision(pair, finding.words.clone())) {
            Some(entry) => document.collisions.push(entry),
            None => document.violations.push(placed.violation(&Violation {
                words: finding.words.clone(),
                value: finding.value,
                limit: finding.limit,
                coordinate: finding.coordinate.as_deref(),
                misplaced: finding.misplaced.as_ref().and_then(misplaced),
            })),
        }
    }
}

/// Nothing where the pose is none.
fn misplaced(entry: &MisplacedEntry) -> Option<Misplaced<'_>> {
    Some(Misplaced { object: &entry.object, pose: pose_from_array(entry.pose)?, angle: entry.angle })
}

fn shapes(robot: &Robot, finding: &FindingEntry) -> Option<[ShapeIndex; 2]> {
    let names = finding.shapes.as_ref()?;
    let find = |name: &String| robot.shapes.iter().position(|shape| shape.name == *name);
    Some([ShapeIndex(find(&names[0])? as u32), ShapeIndex(find(&names[1])? as u32)])
}
