// The binary part of a page: arrays one after the other, each at a multiple of four bytes.

export class Blob {
    #pieces = [];
    #length = 0;

    /** Answers where the array begins. */
    add(array) {
        const offset = this.#length;
        const bytes = Buffer.from(array.buffer, array.byteOffset, array.byteLength);
        const padding = Buffer.alloc((4 - (bytes.length % 4)) % 4);
        this.#pieces.push(bytes, padding);
        this.#length += bytes.length + padding.length;
        return offset;
    }

    bytes() {
        return Buffer.concat(this.#pieces);
    }
}

/** A mesh whose positions are quantised between its least and greatest corner. */
export function mesh(blob, name, positions, indices) {
    const min = [0, 1, 2].map((a) => Math.min(...positions.filter((_, i) => i % 3 === a)));
    const max = [0, 1, 2].map((a) => Math.max(...positions.filter((_, i) => i % 3 === a)));
    const stored = positions.map((v, i) => Math.round(((v - min[i % 3]) / (max[i % 3] - min[i % 3] || 1)) * 65535));
    return {
        name,
        vertices: positions.length / 3,
        triangles: indices.length / 3,
        min,
        max,
        positions: blob.add(Uint16Array.from(stored)),
        indices: blob.add(Uint16Array.from(indices)),
        wide: false,
    };
}
