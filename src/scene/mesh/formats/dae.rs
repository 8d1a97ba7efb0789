//! COLLADA: geometries placed by the nodes of the scene, with units and node transforms.

use crate::scene::mesh::formats::dae_materials as materials;
use crate::scene::mesh::formats::dae_values::{Corners, Inputs, Kind, indices, transform};
use crate::scene::mesh::formats::triangles::{Triangles, UpAxis};
use crate::scene::reading::error::{SceneError, quoted};
use crate::scene::reading::xml::{Xml, elements};
use glam::{DMat3, DMat4, DVec3};
use roxmltree::Node;
use std::collections::HashMap;

/// Most nodes that are placed; nodes may be instanced by other nodes, so a small file can unfold into a huge scene.
const PLACED_NODES: usize = 100_000;
/// Deepest nesting of nodes that instance other nodes.
const NODE_DEPTH: usize = 200;
/// Most numbers in the arrays of a file.
const NUMBERS: usize = 40_000_000;

pub(crate) fn read(file: &str, content: &str, up_axis: UpAxis, mesh: Triangles) -> Result<Triangles, SceneError> {
    let xml = Xml::parse(file, content, &mesh.stop)?;
    let root = xml.document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(xml.error(root, "is not the root of a COLLADA file, <COLLADA> is"));
    }
    let by_id: HashMap<&str, Node<'_, '_>> =
        root.descendants().filter_map(|n| n.attribute("id").map(|id| (id, n))).collect();
    let mut reader = Reader { xml: &xml, by_id, geometries: HashMap::new(), numbers: 0, mesh };
    let unbound = HashMap::new();
    let world_from_scene = asset(&xml, root, up_axis)?;
    match reader.scene_nodes(root)? {
        Some(nodes) => reader.place(nodes, world_from_scene)?,
        // Without a scene, all geometries stand where they are described.
        None => {
            let library = elements(root, "library_geometries").flat_map(|l| elements(l, "geometry"));
            for geometry in library.collect::<Vec<_>>() {
                reader.add(geometry, &world_from_scene, &unbound)?;
            }
        }
    }
    Ok(reader.mesh)
}

/// Scale by the unit, and the turn that the up axis asks for.
fn asset(xml: &Xml<'_>, root: Node<'_, '_>, up_axis: UpAxis) -> Result<DMat4, SceneError> {
    let Some(asset) = xml.optional_child(root, "asset")? else { return Ok(DMat4::IDENTITY) };
    let mut metres = 1.0;
    if let Some(unit) = xml.optional_child(asset, "unit")? {
        metres = xml.number(unit, "meter")?.unwrap_or(1.0);
        if metres <= 0.0 {
            return Err(xml.error(unit, format!("a unit of {metres} metres scales nothing to a solid")));
        }
    }
    let scale = DMat4::from_scale(DVec3::splat(metres));
    let Some(axis) = xml.optional_child(asset, "up_axis")?.filter(|_| up_axis == UpAxis::Declared) else {
        return Ok(scale);
    };
    // COLLADA's right, up and inward axes: X_UP is (−y, x, z), Y_UP is (x, y, z).
    let turn = match axis.text().unwrap_or("Y_UP").trim() {
        "X_UP" => DMat3::from_cols(DVec3::Z, -DVec3::X, -DVec3::Y),
        "Y_UP" => DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y),
        "Z_UP" => DMat3::IDENTITY,
        other => return Err(xml.error(axis, format!("`{}` is no axis: X_UP, Y_UP or Z_UP", quoted(other)))),
    };
    Ok(scale * DMat4::from_mat3(turn))
}

/// From which triangle on a geometry has which symbol of a material.
type Symbols<'a> = Vec<(usize, Option<&'a str>)>;
/// What symbols stand for where a geometry is placed.
type Bound<'a> = HashMap<&'a str, &'a str>;

struct Reader<'a, 'i> {
    pub(crate) xml: &'a Xml<'i>,
    by_id: HashMap<&'a str, Node<'a, 'i>>,
    /// Triangles of geometries in their own coordinates, once read, and from which on they have which symbol of a material.
    geometries: HashMap<roxmltree::NodeId, (Triangles, Symbols<'a>)>,
    numbers: usize,
    mesh: Triangles,
}

impl<'a, 'i> Reader<'a, 'i> {
    /// The nodes of the visual scene that is shown, or of the first one.
    fn scene_nodes(&self, root: Node<'a, 'i>) -> Result<Option<Vec<Node<'a, 'i>>>, SceneError> {
        let instance = elements(root, "scene").flat_map(|s| elements(s, "instance_visual_scene")).next();
        let scene = match instance {
            Some(instance) => Some(self.target(instance, "url")?),
            None => elements(root, "library_visual_scenes").flat_map(|l| elements(l, "visual_scene")).next(),
        };
        Ok(scene.map(|scene| elements(scene, "node").collect()))
    }

    /// What `#id` in an attribute names.
    fn target(&self, node: Node<'a, 'i>, attribute: &str) -> Result<Node<'a, 'i>, SceneError> {
        let url = self.xml.attribute(node, attribute)?;
        url.strip_prefix('#')
            .and_then(|id| self.by_id.get(id))
            .copied()
            .ok_or_else(|| self.xml.error(node, format!("`{}` names nothing in this file", quoted(url))))
    }

    /// Traverses the node hierarchy, instanced nodes included, and adds every geometry it places.
    fn place(&mut self, nodes: Vec<Node<'a, 'i>>, world_from_scene: DMat4) -> Result<(), SceneError> {
        let mut stack: Vec<_> = nodes.into_iter().rev().map(|n| (n, world_from_scene, 0)).collect();
        let mut placed = 0;
        while let Some((node, world_from_parent, depth)) = stack.pop() {
            placed += 1;
            if placed > PLACED_NODES || depth > NODE_DEPTH {
                let hint = "nodes must not instance themselves";
                return Err(self.xml.error(node, "the scene unfolds into too many nodes").hint(hint));
            }
            let world_from_node = world_from_parent * transform(self.xml, node)?;
            let mut below = Vec::new();
            for child in node.children().filter(Node::is_element) {
                match child.tag_name().name() {
                    "node" => below.push(child),
                    "instance_node" => below.push(self.target(child, "url")?),
                    "instance_geometry" => {
                        let geometry = self.target(child, "url")?;
                        self.add(geometry, &world_from_node, &materials::bound(child))?;
                    }
                    "instance_controller" => {
                        let skin = self.target(child, "url")?;
                        if let Some(skin) = elements(skin, "skin").next() {
                            let geometry = self.target(skin, "source")?;
                            self.add(geometry, &world_from_node, &materials::bound(child))?;
                        }
                    }
                    _ => {}
                }
            }
            stack.extend(below.into_iter().rev().map(|n| (n, world_from_node, depth + 1)));
        }
        Ok(())
    }

    /// Adds a geometry's triangles at a place.
    fn add(&mut self, node: Node<'a, 'i>, world_from_geometry: &DMat4, bound: &Bound<'a>) -> Result<(), SceneError> {
        if !self.geometries.contains_key(&node.id()) {
            let geometry = self.geometry(node)?;
            self.geometries.insert(node.id(), geometry);
        }
        let Some((geometry, symbols)) = self.geometries.get(&node.id()) else { return Ok(()) };
        let first = self.mesh.triangles.len();
        for &(start, symbol) in symbols {
            let color = symbol.and_then(|symbol| {
                // Without a binding the symbol is often the material's own name.
                let target = bound.get(symbol).copied().unwrap_or(symbol);
                materials::color(self.xml, &self.by_id, target)
            });
            self.mesh.paint.push((first + start, color));
        }
        let offset = self.mesh.vertices.len() as u32;
        let mirrored = world_from_geometry.determinant() < 0.0;
        for v in &geometry.vertices {
            self.mesh.check_room().map_err(|m| self.xml.error(node, m))?;
            let v = world_from_geometry.transform_point3(*v);
            if !v.is_finite() {
                return Err(self.xml.error(node, "a vertex is not finite once it is placed"));
            }
            self.mesh.vertices.push(v);
        }
        for t in &geometry.triangles {
            self.mesh.check_room().map_err(|m| self.xml.error(node, m))?;
            let [a, b, c] = t.map(|i| i + offset);
            self.mesh.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }

    fn geometry(&mut self, node: Node<'a, 'i>) -> Result<(Triangles, Symbols<'a>), SceneError> {
        let mut geometry = Triangles::watched(&self.mesh.stop);
        let mut symbols = Symbols::new();
        let Some(mesh) = elements(node, "mesh").next() else { return Ok((geometry, symbols)) };
        // Position sources that primitives of this geometry have named so far: where their vertices begin.
        let mut sources: HashMap<roxmltree::NodeId, (u32, u32)> = HashMap::new();
        for primitives in mesh.children().filter(Node::is_element) {
            let Some(kind) = Kind::of(primitives.tag_name().name()) else { continue };
            let inputs = self.inputs(primitives)?;
            let known = sources.get(&inputs.positions.id()).copied();
            let (first, count) = match known {
                Some(range) => range,
                None => {
                    let range = self.positions(inputs.positions, &mut geometry)?;
                    sources.insert(inputs.positions.id(), range);
                    range
                }
            };
            let corners = Corners { inputs: &inputs, first, count };
            symbols.push((geometry.triangles.len(), primitives.attribute("material")));
            self.primitives(primitives, kind, &corners, &mut geometry)?;
        }
        Ok((geometry, symbols))
    }

    /// Which of a primitive's interleaved indices names the position, and where positions lie.
    fn inputs(&self, primitives: Node<'a, 'i>) -> Result<Inputs<'a, 'i>, SceneError> {
        let (mut stride, mut found) = (1, None);
        for input in elements(primitives, "input") {
            let offset = self.xml.number(input, "offset")?.unwrap_or(0.0);
            if !(0.0..64.0).contains(&offset) || offset.fract() != 0.0 {
                return Err(self.xml.error(input, "attribute `offset` wants a whole number below 64"));
            }
            stride = stride.max(offset as usize + 1);
            let vertices = match self.xml.attribute(input, "semantic")? {
                "VERTEX" => self.target(input, "source")?,
                _ => continue,
            };
            let position = elements(vertices, "input").find(|i| i.attribute("semantic") == Some("POSITION"));
            let position = position.ok_or_else(|| self.xml.error(vertices, "names no POSITION"))?;
            found = Some((offset as usize, self.target(position, "source")?));
        }
        let (offset, positions) = found.ok_or_else(|| self.xml.error(primitives, "has no input VERTEX"))?;
        Ok(Inputs { stride, offset, positions })
    }

    /// Reads a source of positions; returns where its vertices begin and how many there are.
    fn positions(&mut self, source: Node<'a, 'i>, mesh: &mut Triangles) -> Result<(u32, u32), SceneError> {
        let xml = self.xml;
        let array = xml.child(source, "float_array")?;
        let values = xml.numbers(array, "array", array.text().unwrap_or_default())?;
        self.count(array, values.len())?;
        if let Some(declared) = xml.number(array, "count")?
            && declared != values.len() as f64
        {
            let message = format!("declares {declared} numbers and holds {}", values.len());
            return Err(xml.error(array, message).hint("the file is cut off or damaged"));
        }
        let accessor = elements(source, "technique_common").flat_map(|t| elements(t, "accessor")).next();
        let whole = |name: &str, default: f64| match accessor {
            Some(a) => xml.number(a, name).map(|n| n.unwrap_or(default)),
            None => Ok(default),
        };
        let (stride, offset) = (whole("stride", 3.0)?, whole("offset", 0.0)?);
        if !(3.0..64.0).contains(&stride) || stride.fract() != 0.0 || !(0.0..1e9).contains(&offset) {
            return Err(xml.error(accessor.unwrap_or(source), "positions want a stride of at least 3 numbers"));
        }
        let first = mesh.vertices.len() as u32;
        let values = values.get(offset as usize..).unwrap_or_default();
        mesh.vertices.extend(values.chunks_exact(stride as usize).map(|c| DVec3::new(c[0], c[1], c[2])));
        Ok((first, mesh.vertices.len() as u32 - first))
    }

    fn count(&mut self, node: Node<'a, 'i>, numbers: usize) -> Result<(), SceneError> {
        self.numbers += numbers;
        match self.numbers > NUMBERS {
            true => Err(self.xml.error(node, format!("the file holds more than {NUMBERS} numbers"))),
            false => Ok(()),
        }
    }

    fn primitives(
        &mut self,
        node: Node<'a, 'i>,
        kind: Kind,
        corners: &Corners<'_, 'a, 'i>,
        mesh: &mut Triangles,
    ) -> Result<(), SceneError> {
        let xml = self.xml;
        let lists: Vec<_> = match kind {
            // A polygon with holes keeps its outline.
            Kind::Polygons => node
                .children()
                .filter_map(|c| match c.tag_name().name() {
                    "p" => Some(c),
                    "ph" => elements(c, "p").next(),
                    _ => None,
                })
                .collect(),
            _ => elements(node, "p").collect(),
        };
        let before = mesh.triangles.len();
        for p in lists {
            let numbers = indices(xml, p)?;
            self.count(p, numbers.len())?;
            let vertices = corners.vertices(xml, p, &numbers)?;
            let room = |result: Result<(), String>| result.map_err(|m| xml.error(p, m));
            match kind {
                Kind::Triangles => {
                    if vertices.len() % 3 != 0 {
                        let message = format!("has {} corners, which make no whole triangles", vertices.len());
                        return Err(xml.error(p, message).hint("the file is cut off or damaged"));
                    }
                    vertices.chunks_exact(3).try_for_each(|t| room(mesh.push_polygon(t)))?;
                }
                Kind::Polygons | Kind::Fans => room(mesh.push_polygon(&vertices))?,
                Kind::Strips => {
                    for (i, t) in vertices.windows(3).enumerate() {
                        let t = if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
                        room(mesh.push_polygon(&t))?;
                    }
                }
                Kind::Polylist => polylist(xml, node, p, &vertices, mesh)?,
            }
        }
        if let (Kind::Triangles, Some(declared)) = (kind, xml.number(node, "count")?)
            && declared != (mesh.triangles.len() - before) as f64
        {
            let message = format!("declares {declared} triangles and holds {}", mesh.triangles.len() - before);
            return Err(xml.error(node, message).hint("the file is cut off or damaged"));
        }
        Ok(())
    }
}

fn polylist(
    xml: &Xml<'_>,
    node: Node<'_, '_>,
    p: Node<'_, '_>,
    vertices: &[u32],
    mesh: &mut Triangles,
) -> Result<(), SceneError> {
    let counts = indices(xml, xml.child(node, "vcount")?)?;
    let mut rest = vertices;
    for count in counts {
        let Some((polygon, behind)) = rest.split_at_checked(count as usize) else {
            let message = "has fewer corners than <vcount> asks for";
            return Err(xml.error(p, message).hint("the file is cut off or damaged"));
        };
        mesh.push_polygon(polygon).map_err(|m| xml.error(p, m))?;
        rest = behind;
    }
    match rest.is_empty() {
        true => Ok(()),
        false => Err(xml.error(p, "has more corners than <vcount> asks for")),
    }
}
