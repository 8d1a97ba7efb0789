//! What links look like: by the visual elements of their models, or else by their collision shapes.

use crate::path_file::loaded_path::LoadedPath;
use crate::scene::load::read_visuals;
use crate::scene::reading::error::SceneError;
use crate::scene::sources::package::PackagePath;
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
            let geometry = shape.geometry.clone();
            links[shape.link.at()].push(Visual { link_from_visual, geometry, color: None });
        }
        Self { links, warnings: Vec::new() }
    }

    /// The visual elements of the models that a path file names. A link of which one cannot be read, and a link without any, shows its
    /// collision shapes.
    ///
    /// # Errors
    /// A model cannot be read.
    pub fn read(path: &LoadedPath, packages: &PackagePath) -> Result<Self, SceneError> {
        let mut visuals = Self::of_shapes(&path.robot);
        for (part, model) in path.robot.parts.iter().zip(&path.models) {
            let (links, warnings) = read_visuals(&model.urdf, model.up_axis, packages)?;
            visuals.warnings.extend(warnings);
            let has_any = links.iter().any(|link| !link.visuals.is_empty());
            for read in links {
                let Some(link) = path.robot.link(&format!("{}/{}", part.name, read.link)) else { continue };
                let shapes = &mut visuals.links[link.at()];
                // A part with visuals shows nothing where it has none: collision shapes there are in the way of nothing to see.
                if (read.incomplete && !shapes.is_empty()) || !has_any {
                    continue;
                }
                *shapes = read
                    .visuals
                    .into_iter()
                    .map(|v| Visual { link_from_visual: v.link_from_visual, geometry: v.geometry, color: v.color })
                    .collect();
            }
        }
        Ok(visuals)
    }
}
