/** Whether two triangles in space touch: a separating axis among the normals, the products of sides, and (flat) the in-plane normals. */

const EPSILON = 1e-12;

type Corners = Float64Array;

/** Nine numbers each. */
export function trianglesTouch(a: Corners, b: Corners): boolean {
    const [na, nb] = [normal(a), normal(b)];
    if (separates(na, a, b) || separates(nb, a, b)) return false;
    for (let i = 0; i < 3; i++) {
        for (let j = 0; j < 3; j++) if (separates(cross(side(a, i), side(b, j)), a, b)) return false;
    }
    if (dot(cross(na, nb), cross(na, nb)) > EPSILON * dot(na, na) * dot(nb, nb)) return true;
    for (let i = 0; i < 3; i++) {
        if (separates(cross(na, side(a, i)), a, b) || separates(cross(nb, side(b, i)), a, b)) return false;
    }
    return true;
}

type V = [number, number, number];

function side(t: Corners, i: number): V {
    const [p, q] = [3 * i, 3 * ((i + 1) % 3)];
    return [t[q]! - t[p]!, t[q + 1]! - t[p + 1]!, t[q + 2]! - t[p + 2]!];
}

function normal(t: Corners): V {
    return cross(side(t, 0), side(t, 1));
}

function cross(a: V, b: V): V {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function dot(a: V, b: V): number {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function separates(axis: V, a: Corners, b: Corners): boolean {
    if (dot(axis, axis) < EPSILON * EPSILON) return false;
    let [aLow, aHigh, bLow, bHigh] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = 0; i < 9; i += 3) {
        const u = axis[0] * a[i]! + axis[1] * a[i + 1]! + axis[2] * a[i + 2]!;
        const v = axis[0] * b[i]! + axis[1] * b[i + 1]! + axis[2] * b[i + 2]!;
        if (u < aLow) aLow = u;
        if (u > aHigh) aHigh = u;
        if (v < bLow) bLow = v;
        if (v > bHigh) bHigh = v;
    }
    return aHigh < bLow || bHigh < aLow;
}
