//! What every page has: parts, links, joints, meshes, documents.

use crate::planner::report::FunnelRow;
use crate::scene::assemble::names::configuration::coordinate_names;
use crate::scene::reading::error::SceneError;
use crate::scene::visuals::Visuals;
use crate::view::document::page::{Document, FORMAT, PageKind};
use crate::view::geometry::blob::Blob;
use crate::view::geometry::mesh_store::{MeshStore, SMALL, TRIANGLES};
use crate::view::html::page::Page;
use crate::view::parts::{documents, tree};
use foliate_components::robot::{Robot, SurfaceIndex};
use std::collections::HashMap;

/// What a page shows apart from what it is about.
#[derive(Clone, Debug)]
pub struct ViewOptions {
    /// Most triangles of all meshes of a page together; meshes are reduced until they have no more, but none below 200 triangles.
    pub triangles: usize,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self { triangles: TRIANGLES }
    }
}

/// A page of a robot and nothing else.
pub(crate) fn base(
    (title, kind): (&str, PageKind),
    robot: &Robot,
    visuals: &Visuals,
    supports: Option<&[SurfaceIndex]>,
    options: &ViewOptions,
) -> Page {
    let (mut store, mut blob) = (MeshStore::default(), Blob::default());
    let links = tree::links(robot, visuals, &mut store);
    let stored = store.write(options.triangles, &mut blob);
    let document = Document {
        format: FORMAT,
        title: title.to_owned(),
        kind,
        facts: Vec::new(),
        warnings: Vec::new(),
        deviation: stored.deviation,
        triangles: stored.triangles,
        meshes: stored.entries,
        parts: tree::parts(robot),
        links,
        joints: tree::joints(robot),
        coordinates: coordinate_names(robot),
        neutral: robot.space.neutral(),
        documents: documents::documents(robot, supports),
        start: None,
        goal: None,
        graph: None,
        path: None,
        pairs: None,
        collisions: Vec::new(),
        violations: Vec::new(),
        search: None,
    };
    let mut page = Page { document, blob };
    visuals.warnings.iter().map(SceneError::to_string).for_each(|warning| page.warn(warning));
    let (shown, asked) = (page.document.triangles[1], options.triangles);
    if shown > asked {
        page.warn(format!(
            "{shown} triangles are shown, more than the {asked} asked for: meshes are not reduced further (none below {SMALL})"
        ));
    }
    page
}

/// Corrects the directions of approach of a page whose robot is read from a path file, which does not carry them: they are those of
/// the scene, where that is known, and not shown otherwise.
pub(crate) fn approach_as_in(page: &mut Page, scene: Option<&Robot>) {
    for handle in &mut page.document.documents.handles {
        let known = scene.and_then(|robot| Some(&robot.handles[robot.handle(&handle.name)?.at()]));
        handle.approach = known.map(|known| known.approaching_direction.to_array());
    }
}

impl Page {
    /// Says in the graph how often a search tried each transition, and how often it reached its target.
    pub fn count_tries(&mut self, funnel: &[FunnelRow]) {
        let rows: HashMap<&str, &FunnelRow> = funnel.iter().map(|row| (row.transition.as_str(), row)).collect();
        for transition in self.document.graph.iter_mut().flat_map(|graph| &mut graph.transitions) {
            if let Some(row) = rows.get(transition.name.as_str()) {
                let counts = &row.statistics;
                (transition.tried, transition.succeeded) = (Some(counts.attempts), Some(counts.reached));
            }
        }
    }

    /// Adds a remark, once.
    pub fn warn(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !self.document.warnings.contains(&text) {
            self.document.warnings.push(text);
        }
    }

    /// Adds a line about the page: a label, and what it says.
    pub fn tell(&mut self, label: &str, text: impl Into<String>) {
        self.document.facts.push([label.to_owned(), text.into()]);
    }
}
