/** Triangles with normals that are smooth where faces meet at less than a crease, sharp elsewhere. */
import { BufferAttribute, BufferGeometry } from "three";

const CREASE = Math.cos((40 * Math.PI) / 180);

/** Unit normals and areas' weights: cross products of the sides, three numbers a face. */
function faceNormals(positions: Float32Array, indices: ArrayLike<number>): Float32Array {
    const normals = new Float32Array(indices.length);
    for (let f = 0; f < indices.length; f += 3) {
        const [a, b, c] = [indices[f]! * 3, indices[f + 1]! * 3, indices[f + 2]! * 3];
        const ux = positions[b]! - positions[a]!;
        const uy = positions[b + 1]! - positions[a + 1]!;
        const uz = positions[b + 2]! - positions[a + 2]!;
        const vx = positions[c]! - positions[a]!;
        const vy = positions[c + 1]! - positions[a + 1]!;
        const vz = positions[c + 2]! - positions[a + 2]!;
        normals[f] = uy * vz - uz * vy;
        normals[f + 1] = uz * vx - ux * vz;
        normals[f + 2] = ux * vy - uy * vx;
    }
    return normals;
}

/** For each vertex the faces around it: `faces[first[v]..first[v + 1]]`. */
function facesOfVertices(vertices: number, indices: ArrayLike<number>): { first: Uint32Array; faces: Uint32Array } {
    const first = new Uint32Array(vertices + 1);
    for (let i = 0; i < indices.length; i++) first[indices[i]! + 1]! += 1;
    for (let v = 0; v < vertices; v++) first[v + 1]! += first[v]!;
    const next = first.slice();
    const faces = new Uint32Array(indices.length);
    for (let i = 0; i < indices.length; i++) faces[next[indices[i]!]!++] = Math.floor(i / 3);
    return { first, faces };
}

export function creased(positions: Float32Array, indices: ArrayLike<number>): BufferGeometry {
    const normals = faceNormals(positions, indices);
    const lengths = new Float32Array(indices.length / 3);
    for (let f = 0; f < lengths.length; f++) lengths[f] = Math.hypot(normals[3 * f]!, normals[3 * f + 1]!, normals[3 * f + 2]!);
    const { first, faces } = facesOfVertices(positions.length / 3, indices);
    const corners = new Float32Array(indices.length * 3);
    const shading = new Int8Array(indices.length * 3);
    for (let i = 0; i < indices.length; i++) {
        const vertex = indices[i]!;
        const own = Math.floor(i / 3);
        let [x, y, z] = [0, 0, 0];
        for (let k = first[vertex]!; k < first[vertex + 1]!; k++) {
            const other = faces[k]!;
            const dot =
                normals[3 * own]! * normals[3 * other]! +
                normals[3 * own + 1]! * normals[3 * other + 1]! +
                normals[3 * own + 2]! * normals[3 * other + 2]!;
            if (dot < CREASE * lengths[own]! * lengths[other]!) continue;
            x += normals[3 * other]!;
            y += normals[3 * other + 1]!;
            z += normals[3 * other + 2]!;
        }
        const scale = 127 / (Math.hypot(x, y, z) || 1);
        shading.set([x * scale, y * scale, z * scale], 3 * i);
        corners.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(corners, 3));
    geometry.setAttribute("normal", new BufferAttribute(shading, 3, true));
    return geometry;
}
