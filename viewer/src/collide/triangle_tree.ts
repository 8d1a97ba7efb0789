/** A tree of boxes over the triangles of a shape, and whether two of them touch in given poses. */
import { Matrix4, type BufferGeometry } from "three";
import { trianglesTouch } from "./triangles";

const LEAF = 4;

export class TriangleTree {
    /** Nine numbers a triangle, in the order of the leaves. */
    readonly triangles: Float64Array;
    /** Six numbers a node: least and greatest corner. */
    readonly boxes: number[] = [];
    /** The right child of a node, whose left child is the next node; -1 for a leaf. */
    readonly right: number[] = [];
    readonly first: number[] = [];
    readonly count: number[] = [];

    constructor(geometry: BufferGeometry) {
        const position = geometry.getAttribute("position");
        const index = geometry.getIndex();
        const corners = index ? index.count : position.count;
        const all = new Float64Array(corners * 3);
        for (let i = 0; i < corners; i++) {
            const vertex = index ? index.getX(i) : i;
            all.set([position.getX(vertex), position.getY(vertex), position.getZ(vertex)], 3 * i);
        }
        const order = Array.from({ length: corners / 3 }, (_, t) => t);
        this.triangles = new Float64Array(all.length);
        let written = 0;
        const build = (from: number, to: number): void => {
            const node = this.right.length;
            const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
            for (let i = from; i < to; i++) {
                for (let k = 0; k < 9; k++) {
                    const v = all[order[i]! * 9 + k]!;
                    if (v < box[k % 3]!) box[k % 3] = v;
                    if (v > box[3 + (k % 3)]!) box[3 + (k % 3)] = v;
                }
            }
            this.boxes.push(...box);
            this.right.push(-1);
            this.first.push(written);
            this.count.push(to - from);
            if (to - from <= LEAF) {
                for (let i = from; i < to; i++) this.triangles.set(all.subarray(order[i]! * 9, order[i]! * 9 + 9), 9 * written++);
                return;
            }
            const size = [0, 1, 2].map((axis) => box[3 + axis]! - box[axis]!);
            const axis = size.indexOf(Math.max(...size));
            const centre = (t: number): number => all[9 * t + axis]! + all[9 * t + 3 + axis]! + all[9 * t + 6 + axis]!;
            const sorted = order.slice(from, to).sort((a, b) => centre(a) - centre(b));
            for (let i = from; i < to; i++) order[i] = sorted[i - from]!;
            const middle = (from + to) >> 1;
            build(from, middle);
            this.right[node] = this.right.length;
            build(middle, to);
        };
        if (order.length > 0) build(0, order.length);
    }
}

/** Whether the surfaces of two shapes touch. A shape wholly inside the other does not. */
export function treesTouch(a: TriangleTree, worldFromA: Matrix4, b: TriangleTree, worldFromB: Matrix4): boolean {
    if (a.right.length === 0 || b.right.length === 0) return false;
    const m = worldFromA.clone().invert().multiply(worldFromB).elements;
    const [ta, tb] = [new Float64Array(9), new Float64Array(9)];
    const leaves = (i: number, j: number): boolean => {
        for (let u = 0; u < b.count[j]!; u++) {
            const from = 9 * (b.first[j]! + u);
            for (let c = 0; c < 9; c += 3) {
                const [x, y, z] = [b.triangles[from + c]!, b.triangles[from + c + 1]!, b.triangles[from + c + 2]!];
                for (let r = 0; r < 3; r++) tb[c + r] = m[r]! * x + m[4 + r]! * y + m[8 + r]! * z + m[12 + r]!;
            }
            for (let t = 0; t < a.count[i]!; t++) {
                ta.set(a.triangles.subarray(9 * (a.first[i]! + t), 9 * (a.first[i]! + t) + 9));
                if (trianglesTouch(ta, tb)) return true;
            }
        }
        return false;
    };
    const visit = (i: number, j: number): boolean => {
        if (!boxesMeet(a.boxes, 6 * i, b.boxes, 6 * j, m)) return false;
        const [leafA, leafB] = [a.right[i]! < 0, b.right[j]! < 0];
        if (leafA && leafB) return leaves(i, j);
        if (leafB || (!leafA && a.count[i]! >= b.count[j]!)) return visit(i + 1, j) || visit(a.right[i]!, j);
        return visit(i, j + 1) || visit(i, b.right[j]!);
    };
    return visit(0, 0);
}

/** A box of A against the box around a turned box of B. */
function boxesMeet(a: number[], i: number, b: number[], j: number, m: number[]): boolean {
    for (let r = 0; r < 3; r++) {
        let centre = m[12 + r]!;
        let reach = 0;
        for (let c = 0; c < 3; c++) {
            const [low, high] = [b[j + c]!, b[j + 3 + c]!];
            centre += m[4 * c + r]! * ((low + high) / 2);
            reach += Math.abs(m[4 * c + r]!) * ((high - low) / 2);
        }
        if (centre + reach < a[i + r]! || centre - reach > a[i + 3 + r]!) return false;
    }
    return true;
}
