//! The binary chunk of a GLB: numbers one after the other, with the views and accessors that find them.

use serde_json::{Value, json};

/// Component types of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
/// Targets of buffer views.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Numbers of a scene that is being built.
#[derive(Default)]
pub(super) struct Buffer {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Buffer {
    /// Positions of vertices; the number of the accessor.
    pub fn positions(&mut self, vertices: &[[f32; 3]]) -> usize {
        let extreme = |pick: fn(f32, f32) -> f32| -> [f32; 3] {
            vertices.iter().copied().reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i]))).unwrap_or_default()
        };
        let view = self.view(vertices.as_flattened().iter().flat_map(|x| x.to_le_bytes()), Some(ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": vertices.len(), "type": "VEC3",
            "min": extreme(f32::min), "max": extreme(f32::max),
        }))
    }

    /// Corners of triangles.
    pub fn corners(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let corners = triangles.as_flattened();
        let (kind, view) = match u16::try_from(vertices) {
            // 65535 itself is no index.
            Ok(count) if count < u16::MAX => {
                let bytes = corners.iter().flat_map(|&i| (i as u16).to_le_bytes());
                (UNSIGNED_SHORT, self.view(bytes, Some(ELEMENT_ARRAY_BUFFER)))
            }
            _ => {
                let bytes = corners.iter().flat_map(|i| i.to_le_bytes());
                (UNSIGNED_INT, self.view(bytes, Some(ELEMENT_ARRAY_BUFFER)))
            }
        };
        self.accessor(json!({ "bufferView": view, "componentType": kind, "count": corners.len(), "type": "SCALAR" }))
    }

    /// Times of samples, which increase.
    pub fn times(&mut self, times: &[f32]) -> usize {
        let view = self.view(times.iter().flat_map(|x| x.to_le_bytes()), None);
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": times.len(), "type": "SCALAR",
            "min": [times.first()], "max": [times.last()],
        }))
    }

    /// Values of an animated property: `VEC3` or `VEC4`.
    pub fn values<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let kind = if N == 3 { "VEC3" } else { "VEC4" };
        let view = self.view(values.as_flattened().iter().flat_map(|x| x.to_le_bytes()), None);
        self.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind }))
    }

    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: Option<u32>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        // Every view begins where a float may.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}
