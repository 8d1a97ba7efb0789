//! glTF 2.0, as text or in one piece (GLB): the meshes of the scene that is shown, placed by its nodes, and their plain colours.
//!
//! Lengths are metres. The y axis points up in glTF; as with COLLADA, coordinates are taken as they are written unless the declared axis
//! is asked for.

use crate::scene::mesh::formats::gltf_document::{
    Accessor, Buffers, Document, Fault, OuterFile, Place, Primitive, read as document,
};
use crate::scene::mesh::formats::triangles::{Triangles, UpAxis};
use crate::scene::reading::error::{SceneError, quoted};
use glam::{DMat3, DMat4, DQuat, DVec3};
use std::borrow::Cow;

/// Most nodes that are placed: a small file could name one as the child of many.
const PLACED_NODES: usize = 100_000;
/// Deepest nesting of nodes.
const NODE_DEPTH: usize = 200;
/// Extensions that only concern looks, by how they begin.
const LOOKS: [&str; 4] = ["KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_"];

/// `outer` reads buffers that lie in other files.
pub(crate) fn read(
    file: &str,
    content: &[u8],
    up_axis: UpAxis,
    outer: OuterFile<'_>,
    mesh: Triangles,
) -> Result<Triangles, SceneError> {
    let located = |Fault(element, line, message)| SceneError::new(file, element, message).at(line);
    let (document, buffers) = document(content, outer).map_err(located)?;
    let strange = |name: &&String| !LOOKS.iter().any(|looks| name.starts_with(looks));
    if let Some(name) = document.extensions_required.iter().find(strange) {
        let message = format!("needs the extension `{}`, which is not read", quoted(name));
        return Err(SceneError::new(file, "document", message).hint("save it without compression and extensions"));
    }
    let mut reader = Reader { document: &document, buffers, mesh };
    let turn = match up_axis {
        UpAxis::AsWritten => DMat4::IDENTITY,
        UpAxis::Declared => DMat4::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y)),
    };
    reader.place(turn).map_err(located)?;
    Ok(reader.mesh)
}

struct Reader<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    mesh: Triangles,
}

fn fault<T>(element: impl Into<String>, message: impl Into<String>) -> Result<T, Fault> {
    Err(Fault(element.into(), None, message.into()))
}

impl Reader<'_> {
    /// Places the nodes of the scene; without a scene all that are children of none, without nodes all meshes.
    fn place(&mut self, world: DMat4) -> Result<(), Fault> {
        let document = self.document;
        if document.nodes.is_empty() {
            return (0..document.meshes.len()).try_for_each(|mesh| self.add(mesh, &world));
        }
        let roots = match (document.scene, document.scenes.as_slice()) {
            (Some(scene), scenes) => match scenes.get(scene) {
                Some(scene) => scene.nodes.clone(),
                None => return fault("scene", format!("names scene {scene}, there are {}", scenes.len())),
            },
            (None, [first, ..]) => first.nodes.clone(),
            (None, []) => {
                let mut is_child = vec![false; document.nodes.len()];
                let children = document.nodes.iter().flat_map(|node| &node.children);
                children.for_each(|&child| is_child.get_mut(child).into_iter().for_each(|known| *known = true));
                (0..is_child.len()).filter(|&node| !is_child[node]).collect()
            }
        };
        let mut stack: Vec<(Place, DMat4, usize)> = roots.into_iter().rev().map(|node| (node, world, 0)).collect();
        let mut placed = 0;
        while let Some((index, world_from_parent, depth)) = stack.pop() {
            placed += 1;
            if placed > PLACED_NODES || depth > NODE_DEPTH {
                return fault(format!("node {index}"), "the scene unfolds into too many nodes");
            }
            let Some(node) = document.nodes.get(index) else {
                return fault(format!("node {index}"), format!("is named, there are {}", document.nodes.len()));
            };
            let own = match node.matrix {
                Some(matrix) => DMat4::from_cols_array(&matrix),
                None => DMat4::from_scale_rotation_translation(
                    node.scale.map_or(DVec3::ONE, DVec3::from_array),
                    rotation(node.rotation)
                        .map_or_else(|| fault(format!("node {index}"), "its rotation has no length"), Ok)?,
                    node.translation.map_or(DVec3::ZERO, DVec3::from_array),
                ),
            };
            let world_from_node = world_from_parent * own;
            if let Some(mesh) = node.mesh {
                self.add(mesh, &world_from_node)?;
            }
            stack.extend(node.children.iter().rev().map(|&child| (child, world_from_node, depth + 1)));
        }
        Ok(())
    }

    /// Adds the triangles of a mesh at a place.
    fn add(&mut self, index: Place, world_from_mesh: &DMat4) -> Result<(), Fault> {
        let element = format!("mesh {index}");
        let Some(mesh) = self.document.meshes.get(index) else {
            return fault(element, format!("is named, there are {}", self.document.meshes.len()));
        };
        for primitive in &mesh.primitives {
            self.add_primitive(primitive, world_from_mesh).map_err(|message| Fault(element.clone(), None, message))?;
        }
        Ok(())
    }

    fn add_primitive(&mut self, primitive: &Primitive, world_from_mesh: &DMat4) -> Result<(), String> {
        let mode = primitive.mode.unwrap_or(4);
        // Points and lines bound no solid.
        let (Some(position), 4..=6) = (primitive.attributes.position, mode) else { return Ok(()) };
        let material = primitive.material.and_then(|material| self.document.materials.get(material));
        let color = material.map(|m| m.pbr_metallic_roughness.base_color_factor.unwrap_or([1.0; 4]));
        self.mesh.paint.push((self.mesh.triangles.len(), color.map(|color| color.map(|x| x.clamp(0.0, 1.0)))));
        let first = self.mesh.vertices.len();
        let positions = Values::of(self.document, &self.buffers, position, "VEC3")?;
        for index in 0..positions.count {
            self.mesh.check_room()?;
            let p = world_from_mesh.transform_point3(DVec3::from_array(positions.point(index)));
            if !p.is_finite() {
                return Err(format!("vertex {index} is not finite where it is placed"));
            }
            self.mesh.vertices.push(p);
        }
        let indices = primitive.indices.map(|i| Values::of(self.document, &self.buffers, i, "SCALAR")).transpose()?;
        let corners = indices.as_ref().map_or(positions.count, |indices| indices.count);
        let corner = |i: usize| match indices.as_ref().map_or(i, |indices| indices.index(i)) {
            index if index < positions.count => Ok((first + index) as u32),
            index => Err(format!("names vertex {index}, there are {}", positions.count)),
        };
        let count = if mode == 4 { corners / 3 } else { corners.saturating_sub(2) };
        let mirrored = world_from_mesh.determinant() < 0.0;
        for i in 0..count {
            self.mesh.check_room()?;
            let [a, b, c] = match mode {
                4 => [3 * i, 3 * i + 1, 3 * i + 2],
                5 if i % 2 == 1 => [i + 1, i, i + 2],
                5 => [i, i + 1, i + 2],
                _ => [0, i + 1, i + 2],
            };
            let [a, b, c] = [corner(a)?, corner(b)?, corner(c)?];
            self.mesh.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }
}

/// The rotation of a quaternion x y z w; none where it has no length.
fn rotation(quaternion: Option<[f64; 4]>) -> Option<DQuat> {
    let Some(quaternion) = quaternion else { return Some(DQuat::IDENTITY) };
    let quaternion = DQuat::from_array(quaternion);
    let length = quaternion.length();
    (length.is_finite() && length > 1e-6).then(|| quaternion / length)
}

/// The numbers of an accessor, all of which lie in their buffer.
struct Values<'a> {
    bytes: &'a [u8],
    stride: usize,
    /// Bytes of one number.
    size: usize,
    count: usize,
}

impl<'a> Values<'a> {
    fn of(document: &'a Document, buffers: &'a [Cow<'_, [u8]>], index: Place, shape: &str) -> Result<Self, String> {
        let fail = |what: &str| Err(format!("accessor {index} {what}"));
        let Some(accessor) = document.accessors.get(index) else { return fail("is named and not there") };
        let Accessor { buffer_view: Some(view), sparse: None, count, byte_offset, .. } = *accessor else {
            return fail("has no data of its own, or sparse data, which are not read");
        };
        let size = match (shape, accessor.component_type) {
            ("VEC3", 5126) | ("SCALAR", 5125) => 4,
            ("SCALAR", 5123) => 2,
            ("SCALAR", 5121) => 1,
            (_, other) => return fail(&format!("has numbers of the kind {other}, which are not read")),
        };
        if accessor.shape != shape {
            return fail(&format!("holds {}, not {shape}", quoted(&accessor.shape)));
        }
        let whole = if shape == "VEC3" { 3 * size } else { size };
        let found = document.buffer_views.get(view);
        let Some((view, buffer)) = found.and_then(|view| Some((view, buffers.get(view.buffer)?))) else {
            return fail("names a view or a buffer that is not there");
        };
        let stride = view.byte_stride.unwrap_or(whole);
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end)).and_then(|bytes| bytes.get(byte_offset..));
        let needed = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(whole));
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if stride >= whole && needed <= bytes.len() => {
                Ok(Self { bytes, stride, size, count })
            }
            _ => fail("reaches beyond its buffer"),
        }
    }

    /// The bytes of a number, the last of which counts most.
    fn number(&self, at: usize) -> u32 {
        self.bytes[at..at + self.size].iter().rev().fold(0, |bits, &byte| bits << 8 | u32::from(byte))
    }

    fn index(&self, i: usize) -> usize {
        self.number(i * self.stride) as usize
    }

    fn point(&self, i: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| f64::from(f32::from_bits(self.number(i * self.stride + k * self.size))))
    }
}
