/** The roadmap of a search: nodes in the order in which they grew, edges, trees, states, components. */
import type { SearchData, ViewDocument } from "../data/document";
import type { Arrays } from "../data/read";
import { Kinematics } from "./kinematics";

export type Colouring = "tree" | "state" | "component";

export class Roadmap {
    readonly count: number;
    readonly step: Uint32Array;
    readonly edges: Uint32Array;
    readonly lastStep: number;
    private readonly nodes: Float32Array;
    private readonly tree: Uint16Array;
    private readonly state: Uint16Array;
    private readonly components: Uint32Array;
    private readonly width: number;
    private readonly kinematics: Kinematics;

    constructor(
        private readonly view: ViewDocument,
        readonly data: SearchData,
        arrays: Arrays,
    ) {
        this.count = data.count;
        this.width = view.coordinates.length;
        this.nodes = arrays.float32(data.nodes, data.count * this.width);
        this.tree = arrays.uint16(data.tree, data.count);
        this.state = arrays.uint16(data.state, data.count);
        this.step = arrays.uint32(data.step, data.count);
        this.edges = arrays.uint32(data.edges, data.edge_count * 2);
        this.lastStep = this.step.reduce((most, step) => Math.max(most, step), 0);
        this.kinematics = new Kinematics(view);
        this.components = this.joined();
    }

    configuration(node: number): Float32Array {
        return this.nodes.subarray(node * this.width, (node + 1) * this.width);
    }

    stateOf(node: number): number {
        return this.state[node] ?? 0xffff;
    }

    /** Where the origin of a link is at each node, three numbers a node. */
    positions(link: number): Float32Array {
        const out = new Float32Array(this.count * 3);
        for (let node = 0; node < this.count; node++) {
            const e = this.kinematics.updateChain(link, this.configuration(node)).elements;
            out.set([e[12]!, e[13]!, e[14]!], node * 3);
        }
        return out;
    }

    /** The number by which a node is coloured. */
    group(node: number, by: Colouring): number {
        if (by === "tree") return this.tree[node]!;
        return by === "state" ? this.state[node]! : this.components[node]!;
    }

    groupName(group: number, by: Colouring): string {
        if (by === "tree") return this.data.trees?.[group] ?? `tree ${group}`;
        if (by === "component") return `component ${group + 1}`;
        const state = this.view.graph?.states[group];
        return state ? state.words || state.name : group === 0xffff ? "unknown" : `state ${group}`;
    }

    /** Groups by how many nodes they have, the largest first. */
    groups(by: Colouring): [number, number][] {
        const counts = new Map<number, number>();
        for (let node = 0; node < this.count; node++) {
            const group = this.group(node, by);
            counts.set(group, (counts.get(group) ?? 0) + 1);
        }
        return [...counts].sort((a, b) => b[1] - a[1] || a[0] - b[0]);
    }

    /** Connected components, numbered by size. */
    private joined(): Uint32Array {
        const root = Uint32Array.from({ length: this.count }, (_, i) => i);
        const find = (i: number): number => {
            while (root[i] !== i) i = root[i] = root[root[i]!]!;
            return i;
        };
        for (let e = 0; e < this.edges.length; e += 2) root[find(this.edges[e]!)] = find(this.edges[e + 1]!);
        const sizes = new Map<number, number>();
        for (let i = 0; i < this.count; i++) sizes.set(find(i), (sizes.get(find(i)) ?? 0) + 1);
        const order = [...sizes].sort((a, b) => b[1] - a[1] || a[0] - b[0]);
        const rank = new Map(order.map(([node], i) => [node, i]));
        return Uint32Array.from({ length: this.count }, (_, i) => rank.get(find(i))!);
    }
}
