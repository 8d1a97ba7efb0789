//! What links look like: by the visual elements of their models, or else by their collision shapes.

use crate::scene::assemble::scene::Scene;
use crate::scene::load::{ReadModel, VisualSource, read_visuals};
use crate::scene::mesh::formats::triangles::UpAxis;
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
use crate::scene::urdf::visuals::VisualModel;
use foliate_components::Pose;
use foliate_components::robot::Robot;
use foliate_components::robot::shape::Geometry;

/// A solid that a link shows.
#[derive(Clone, Debug)]
pub struct Visual {
    /// Its pose in the link.
    pub link_from_visual: Pose,
    /// The solid.
    pub geometry: Geometry,
    /// Red, green, blue and opacity from 0 to 1, where they are known.
    pub color: Option<[f64; 4]>,
    /// The file that could not be read, where this stands in its place.
    pub missing: Option<String>,
}

/// What all links of a robot look like.
#[derive(Clone, Debug, Default)]
pub struct Visuals {
    /// By link.
    pub links: Vec<Vec<Visual>>,
    /// Remarks about what cannot be read.
    pub warnings: Vec<SceneError>,
}

impl Visuals {
    /// The collision shapes of the links.
    #[must_use]
    pub fn of_shapes(robot: &Robot) -> Self {
        let mut links = vec![Vec::new(); robot.links.len()];
        for shape in &robot.shapes {
            let joint_from_link = robot.links[shape.link.at()].joint_from_link;
            let link_from_visual = joint_from_link.inverse() * shape.joint_from_shape;
            let (geometry, missing) = (shape.geometry.clone(), shape.geometry.missing_file().map(str::to_owned));
            links[shape.link.at()].push(Visual { link_from_visual, geometry, color: None, missing });
        }
        Self { links, warnings: Vec::new() }
    }

    /// The visual elements of a scene's models and nothing else.
    ///
    /// # Errors
    /// A model cannot be read.
    pub fn of_scene(scene: &Scene, packages: &PackagePath) -> Result<Self, SceneError> {
        let models = scene.parts.iter().map(|part| (VisualSource::Again(&part.urdf), part.mesh_up_axis));
        Self::alone(&scene.problem.robot, models, &packages.clone().with_readable(&scene.directory))
    }

    /// The visual elements of a model that is the only part of a robot and nothing else; none of one that has no file.
    ///
    /// # Errors
    /// The model cannot be read.
    pub fn of_model(
        robot: &Robot,
        model: &ReadModel,
        up_axis: UpAxis,
        packages: &PackagePath,
    ) -> Result<Self, SceneError> {
        let models = model.urdf().into_iter().map(|urdf| (VisualSource::Again(urdf), up_axis));
        Self::alone(robot, models, packages)
    }

    /// The visual elements of models, by their paths or `package://` URLs, in the order of the robot's parts, and nothing else.
    pub(crate) fn of_names<'a>(
        robot: &Robot,
        names: impl Iterator<Item = (&'a str, UpAxis)>,
        packages: &PackagePath,
    ) -> Result<Self, SceneError> {
        Self::alone(robot, names.map(|(name, up_axis)| (VisualSource::Name(name), up_axis)), packages)
    }

    /// As [`Self::of_names`], and the collision shapes of links that have none, or of which one cannot be read.
    pub(crate) fn with_shapes<'a>(
        robot: &Robot,
        names: impl Iterator<Item = (&'a str, UpAxis)>,
        packages: &PackagePath,
    ) -> Result<Self, SceneError> {
        let mut visuals = Self::of_shapes(robot);
        visuals.add(robot, names.map(|(name, up_axis)| (VisualSource::Name(name), up_axis)), packages, true)?;
        Ok(visuals)
    }

    fn alone<'a>(
        robot: &Robot,
        models: impl Iterator<Item = (VisualSource<'a>, UpAxis)>,
        packages: &PackagePath,
    ) -> Result<Self, SceneError> {
        let mut visuals = Self { links: vec![Vec::new(); robot.links.len()], warnings: Vec::new() };
        visuals.add(robot, models, packages, false)?;
        Ok(visuals)
    }

    /// Puts the visual elements of models in the place of what links show; with `keeps` only where that is better to look at.
    fn add<'a>(
        &mut self,
        robot: &Robot,
        models: impl Iterator<Item = (VisualSource<'a>, UpAxis)>,
        packages: &PackagePath,
        keeps: bool,
    ) -> Result<(), SceneError> {
        for (part, (urdf, up_axis)) in robot.parts.iter().zip(models) {
            let (links, warnings) = read_visuals(&urdf, up_axis, packages)?;
            self.warnings.extend(warnings);
            let has_any = links.iter().any(|link| !link.visuals.is_empty());
            for read in links {
                let Some(link) = robot.link(&format!("{}/{}", part.name, read.link)) else { continue };
                let shapes = &mut self.links[link.at()];
                // A part with visuals shows nothing on a link that has none: a collision shape there could hide visuals of other links.
                if keeps && ((read.incomplete && !shapes.is_empty()) || !has_any) {
                    continue;
                }
                let visual = |v: VisualModel| Visual {
                    link_from_visual: v.link_from_visual,
                    missing: v.geometry.missing_file().map(str::to_owned),
                    geometry: v.geometry,
                    color: v.color,
                };
                *shapes = read.visuals.into_iter().map(visual).collect();
            }
        }
        Ok(())
    }
}
