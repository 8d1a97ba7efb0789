/** Geometries of shapes, each made once and shared by all that show it. */
import { BoxGeometry, BufferGeometry, CapsuleGeometry, CylinderGeometry, EdgesGeometry, SphereGeometry } from "three";
import type { Shape, ViewDocument } from "../data/document";
import type { Arrays } from "../data/read";
import { creased } from "./mesh_normals";

export interface Triangles {
    positions: Float32Array;
    indices: ArrayLike<number>;
}

export class Geometries {
    private readonly made = new Map<string, BufferGeometry>();
    private readonly edges = new Map<BufferGeometry, BufferGeometry>();

    constructor(
        private readonly view: ViewDocument,
        private readonly arrays: Arrays,
    ) {}

    /** The geometry of a shape about its own origin; cylinders and capsules along z. */
    of(shape: Shape): BufferGeometry {
        const key = JSON.stringify(shape);
        let geometry = this.made.get(key);
        if (!geometry) {
            geometry = this.make(shape);
            this.made.set(key, geometry);
        }
        return geometry;
    }

    /** Sharp edges, for reading one geometry through another. */
    edgesOf(geometry: BufferGeometry): BufferGeometry {
        let edges = this.edges.get(geometry);
        if (!edges) {
            edges = new EdgesGeometry(geometry, 30);
            this.edges.set(geometry, edges);
        }
        return edges;
    }

    mesh(index: number): Triangles {
        const data = this.view.meshes[index];
        if (!data) throw new Error(`there is no mesh ${index}`);
        const stored = this.arrays.uint16(data.positions, data.vertices * 3);
        const positions = new Float32Array(stored.length);
        for (let i = 0; i < stored.length; i++) {
            const axis = i % 3;
            const low = data.min[axis]!;
            positions[i] = low + (stored[i]! / 65535) * (data.max[axis]! - low);
        }
        const corners = data.triangles * 3;
        const indices = data.wide ? this.arrays.uint32(data.indices, corners) : this.arrays.uint16(data.indices, corners);
        return { positions, indices };
    }

    private make(shape: Shape): BufferGeometry {
        if ("mesh" in shape) {
            const { positions, indices } = this.mesh(shape.mesh);
            return creased(positions, indices);
        }
        if ("box" in shape) return new BoxGeometry(...shape.box);
        if ("sphere" in shape) return new SphereGeometry(shape.sphere, 32, 20);
        if ("cylinder" in shape) return new CylinderGeometry(shape.cylinder[0], shape.cylinder[0], shape.cylinder[1], 36).rotateX(Math.PI / 2);
        return new CapsuleGeometry(shape.capsule[0], shape.capsule[1], 10, 28).rotateX(Math.PI / 2);
    }
}
