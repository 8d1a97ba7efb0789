// A constraint graph of four states, and a small search through it.
import { carried } from "./sample_robot.mjs";

export function sampleGraph(counted) {
    const state = (id, name, words, x, y, passed_through, lines) => ({ id, name, words, x, y, w: 132, h: 46, passed_through, lines });
    const states = [
        state(0, "free", "the box lies on the table", 20, 160, false, ["box on table"]),
        state(1, "hand > box/top", "the hand holds the box", 420, 160, false, ["hand holds box"]),
        state(2, "pregrasp", "the hand is above the box", 220, 40, true, ["pregrasp"]),
        state(3, "preplace", "the box is above the table", 220, 280, true, ["preplace"]),
    ];
    const centre = (s) => [states[s].x + 66, states[s].y + 23];
    const between = (from, to, bend) => {
        const [a, b] = [centre(from), centre(to)];
        const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        const l = Math.hypot(dx, dy);
        const p = (u, k) => [a[0] + u * dx - (k * bend * dy) / l, a[1] + u * dy + (k * bend * dx) / l];
        return [p(0.36, 0.5), p(0.45, 1), p(0.55, 1), p(0.64, 0.5)];
    };
    const loop = (s) => {
        const [x, y] = centre(s);
        return [[x - 22, y + 23], [x - 34, y + 74], [x + 34, y + 74], [x + 22, y + 23]];
    };
    const transition = (id, from, to, name, words, kind, points, tried, succeeded, waypoints) => ({ id, from, to, name, words, kind, points, tried: counted ? tried : null, succeeded: counted ? succeeded : null, waypoints });
    const transitions = [
        transition(0, 0, 2, "free to pregrasp", "the hand moves above the box", "regular", between(0, 2, 20), 420, 260, ["pregrasp"]),
        transition(1, 2, 1, "pregrasp to grasp", "the hand grasps the box", "regular", between(2, 1, 20), 310, 40),
        transition(2, 1, 1, "carry", "the hand carries the box", "loop", loop(1), 900, 870),
        transition(3, 1, 3, "grasp to preplace", "the hand lowers the box", "crossed", between(1, 3, 20), 150, 6),
        transition(4, 3, 0, "preplace to free", "the hand lets the box go", "regular", between(3, 0, 20), 80, 70),
        transition(5, 0, 0, "move", "the hand moves on its own", "loop", loop(0), 1200, 1130),
    ];
    return { width: 572, height: 366, states, transitions };
}

/** Numbers that look random and are the same each time. */
function numbers(seed) {
    let s = seed;
    return () => ((s = (s * 1103515245 + 12345) % 2147483648) / 2147483648);
}

export function sampleSearch(blob, corners) {
    const random = numbers(7);
    const [nodes, tree, state, step, edges] = [[], [], [], [], []];
    const count = 300;
    for (let i = 0; i < count; i++) {
        const isGoal = i % 3 === 2;
        const holds = i > 60 && i % 4 !== 0;
        const near = isGoal ? corners.at(-1) : corners[holds ? 4 : 0];
        const reach = 0.15 + (1.5 * i) / count;
        const a = near.slice(0, 4).map((v, k) => (k < 2 ? v + (random() - 0.5) * reach : v));
        nodes.push(...a, ...(holds ? carried(a) : near.slice(4)));
        tree.push(isGoal ? 1 : 0);
        state.push(holds ? 1 : 0);
        step.push(i * 5);
        if (i > 2) edges.push(i, Math.max(isGoal ? 2 : i % 3, i - 3 * (1 + Math.floor(random() * 6))));
    }
    const inCollision = [...corners[5]];
    inCollision[0] -= 0.45;
    inCollision.splice(4, 7, ...carried(inCollision));
    const row = (transition, tried, projected, free, reached, pairs) => ({ transition, tried, projected, free, reached, pairs });
    return {
        nodes: blob.add(Float32Array.from(nodes)),
        count,
        tree: blob.add(Uint16Array.from(tree)),
        state: blob.add(Uint16Array.from(state)),
        step: blob.add(Uint32Array.from(step)),
        edges: blob.add(Uint32Array.from(edges)),
        edge_count: edges.length / 2,
        trees: ["start", "goal"],
        outcome: "time limit",
        words: ["3060 candidates in 0.41 s.", "Most candidates were lost where the hand lowers the box."],
        funnel: [
            row(5, 1200, 1200, 1160, 1130, []),
            row(2, 900, 900, 880, 870, []),
            row(0, 420, 410, 300, 260, [{ links: [2, 9], count: 81, configuration: null }]),
            row(1, 310, 200, 60, 40, []),
            row(3, 150, 120, 9, 6, [{ links: [7, 9], count: 97, configuration: inCollision, depth: 0.018 }, { links: [3, 9], count: 14, configuration: null }]),
            row(4, 80, 78, 72, 70, []),
        ],
    };
}
