/** The roadmap in the scene: a point where a hand or an object is at each node, lines for edges, up to a step. */
import { BufferAttribute, BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial, type Raycaster } from "three";
import { groupColour } from "../app/colours";
import { theme } from "../app/theme";
import type { Colouring, Roadmap } from "../motion/roadmap";

export class Cloud {
    readonly root = new Group();
    private readonly points: Points<BufferGeometry, PointsMaterial>;
    private readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
    /** Nodes and edges in the order in which they are revealed. */
    private readonly nodeOrder: Uint32Array;
    private readonly edgeOrder: Uint32Array;
    private readonly edgeStep: Uint32Array;

    constructor(
        private readonly roadmap: Roadmap,
        size: number,
    ) {
        const { count, edges, step } = roadmap;
        this.edgeStep = Uint32Array.from({ length: edges.length / 2 }, (_, e) => Math.max(step[edges[2 * e]!]!, step[edges[2 * e + 1]!]!));
        const sorted = (steps: Uint32Array): Uint32Array => Uint32Array.from(steps.keys()).sort((a, b) => steps[a]! - steps[b]! || a - b);
        this.nodeOrder = sorted(step);
        this.edgeOrder = sorted(this.edgeStep);
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(new Float32Array(count * 3), 3));
        geometry.setAttribute("color", new BufferAttribute(new Float32Array(count * 3), 3));
        this.points = new Points(geometry, new PointsMaterial({ size, vertexColors: true, transparent: true, opacity: 0.9 }));
        const lines = new BufferGeometry();
        lines.setAttribute("position", new BufferAttribute(new Float32Array(edges.length * 3), 3));
        lines.setAttribute("color", new BufferAttribute(new Float32Array(edges.length * 3), 3));
        this.lines = new LineSegments(lines, new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.4 }));
        this.points.frustumCulled = this.lines.frustumCulled = false;
        this.root.add(this.lines, this.points);
    }

    /** Places all points where a link is, and colours them. */
    arrange(link: number, by: Colouring): void {
        const at = this.roadmap.positions(link);
        const colours = new Map<number, Color>();
        const rank = new Map(this.roadmap.groups(by).map(([group], i) => [group, by === "component" ? i : group]));
        const colourOf = (node: number): Color => {
            const group = this.roadmap.group(node, by);
            let colour = colours.get(group);
            if (!colour) colours.set(group, (colour = new Color(groupColour(rank.get(group) ?? group, theme.value))));
            return colour;
        };
        this.write(this.points.geometry, this.nodeOrder.length, (i) => this.nodeOrder[i]!, at, colourOf);
        const end = (i: number): number => this.roadmap.edges[2 * this.edgeOrder[i >> 1]! + (i & 1)]!;
        this.write(this.lines.geometry, this.edgeOrder.length * 2, end, at, colourOf);
    }

    /** Shows what had grown by a step; answers how many nodes and edges. */
    reveal(step: number): { nodes: number; edges: number } {
        const until = (order: Uint32Array, steps: Uint32Array): number => {
            let low = 0;
            let high = order.length;
            while (low < high) {
                const middle = (low + high) >> 1;
                if (steps[order[middle]!]! <= step) low = middle + 1;
                else high = middle;
            }
            return low;
        };
        const nodes = until(this.nodeOrder, this.roadmap.step);
        const edges = until(this.edgeOrder, this.edgeStep);
        this.points.geometry.setDrawRange(0, nodes);
        this.lines.geometry.setDrawRange(0, edges * 2);
        return { nodes, edges };
    }

    /** The node under a ray. */
    hit(ray: Raycaster): number | null {
        const found = ray.intersectObject(this.points, false)[0];
        return found?.index === undefined ? null : this.nodeOrder[found.index]!;
    }

    private write(geometry: BufferGeometry, n: number, node: (i: number) => number, at: Float32Array, colour: (node: number) => Color): void {
        const position = geometry.getAttribute("position") as BufferAttribute;
        const colours = geometry.getAttribute("color") as BufferAttribute;
        for (let i = 0; i < n; i++) {
            const k = node(i);
            position.setXYZ(i, at[3 * k]!, at[3 * k + 1]!, at[3 * k + 2]!);
            const { r, g, b } = colour(k);
            colours.setXYZ(i, r, g, b);
        }
        position.needsUpdate = colours.needsUpdate = true;
        geometry.computeBoundingSphere();
    }
}
