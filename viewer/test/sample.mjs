// A document of each kind, for tests and for looking at: an arm brings a box past a ball.
import { Blob } from "./blob.mjs";
import { sampleGraph, sampleSearch } from "./sample_search.mjs";
import { BOX, carried, COORDINATES, DOWN, FROM, JOINTS, reach, robot, TABLE, TO } from "./sample_robot.mjs";

const OPEN = 0.06;
const CLOSED = BOX[1] / 2;
const LIFTED = 0.02;

const box = ([x, y], z = TABLE + BOX[2] / 2) => [x, y, z, 0, 0, 0, 1];
const arm = (place, lift, finger) => [...reach(place), lift, finger];

/** Corner configurations, and what the motion to each is. */
function corners() {
    const rest = [2.2, -1.6, 0, OPEN];
    const put = carried(arm(TO, DOWN, CLOSED));
    return [
        { q: [...rest, ...box(FROM)] },
        { q: [...arm(FROM, LIFTED, OPEN), ...box(FROM)], s: 0, state: 0, transition: 0, words: "the hand moves above box", colour: 0 },
        { q: [...arm(FROM, DOWN, OPEN), ...box(FROM)], s: 0, state: 2, transition: 0, words: "the hand approaches box", colour: 2 },
        { q: [...arm(FROM, DOWN, CLOSED), ...box(FROM)], s: 0, state: 2, transition: 0, words: "the hand closes on box", colour: 2, event: ["grasp", "the hand grasps box"] },
        { q: [...arm(FROM, LIFTED, CLOSED), ...carried(arm(FROM, LIFTED, CLOSED))], s: 1, state: 1, transition: 1, words: "the hand lifts box", colour: 1 },
        { q: [...arm(TO, LIFTED, CLOSED), ...carried(arm(TO, LIFTED, CLOSED))], s: 1, state: 1, transition: 2, words: "the hand carries box", colour: 1 },
        { q: [...arm(TO, DOWN, CLOSED), ...put], s: 1, state: 3, transition: 3, words: "the hand puts box on the table", colour: 3, event: ["release", "the hand releases box"] },
        { q: [...arm(TO, DOWN, OPEN), ...put], s: 0, state: 3, transition: 3, words: "the hand opens", colour: 3 },
        { q: [...arm(TO, LIFTED, OPEN), ...put], s: 0, state: 0, transition: 4, words: "the hand leaves box", colour: 0 },
        { q: [...rest, ...put], s: 0, state: 0, transition: 5, words: "the hand moves on its own", colour: 0 },
    ];
}

function samplePath(blob, refused) {
    const rate = 50;
    const all = corners();
    const [times, configurations, segments, events] = [[], [], [], []];
    let t = 0;
    for (let i = 1; i < all.length; i++) {
        const [from, to] = [all[i - 1].q, all[i].q];
        const span = Math.max(0.3, 1.6 * Math.max(...to.slice(0, 4).map((v, k) => Math.abs(v - from[k]))));
        const steps = Math.round(span * rate);
        for (let k = i === 1 ? 0 : 1; k <= steps; k++) {
            const u = k / steps;
            const s = u * u * (3 - 2 * u);
            const a = from.slice(0, 4).map((v, j) => v + s * (to[j] - v));
            times.push(t + u * span);
            configurations.push(...a, ...(all[i].s === 1 ? carried(a) : from.slice(4)));
        }
        const { state, transition, words, colour, event } = all[i];
        segments.push({ from: t, to: t + span, state, transition, words, colour });
        t += span;
        if (event) events.push({ time: t, kind: event[0], words: event[1], gripper: "arm/hand", handle: "box/top" });
    }
    const n = COORDINATES.length;
    const at = (k, i) => configurations[k * n + i];
    const velocities = times.flatMap((_, k) => {
        const [a, b] = [Math.max(k - 1, 0), Math.min(k + 1, times.length - 1)];
        const rateOf = (i) => (at(b, i) - at(a, i)) / (times[b] - times[a]);
        return [...[0, 1, 2, 3, 4, 5, 6].map(rateOf), 0, 0, 2 * rateOf(9)];
    });
    const [values, points, pair] = [[], [], []];
    times.forEach((_, k) => {
        const [x, y, z] = [at(k, 4), at(k, 5), at(k, 6)];
        const ball = [0.74, 0.05, TABLE + 0.07];
        const d = Math.hypot(x - ball[0], y - ball[1], z - ball[2]);
        values.push(d - 0.07 - 0.03);
        points.push(x, y, z, ...ball.map((c, i) => c + (0.07 * ([x, y, z][i] - c)) / d));
        pair.push(0);
    });
    return {
        timed: true,
        duration: t,
        times: blob.add(Float32Array.from(times)),
        configurations: blob.add(Float32Array.from(configurations)),
        samples: times.length,
        segments,
        events,
        clearance: {
            times: blob.add(Float32Array.from(times)),
            values: blob.add(Float32Array.from(values)),
            samples: times.length,
            pairs: [[7, 9]],
            pair: blob.add(Uint16Array.from(pair)),
            points: blob.add(Float32Array.from(points)),
        },
        velocities: blob.add(Float32Array.from(velocities)),
        verdict: refused ? "refused" : "proved",
        refused: refused ? [{ time: null, words: "the file names another model", links: null }, { time: t * 0.55, words: "box/body and room/ball are 3.2 mm apart; the margin is 5 mm", links: [7, 9] }] : [],
    };
}

const DOCUMENTS = {
    grippers: [{ name: "arm/hand", link: 4, pose: [0, 0, -0.045, 0, Math.SQRT1_2, 0, Math.SQRT1_2] }],
    handles: [{ name: "box/top", link: 7, pose: [0, 0, 0, 0, Math.SQRT1_2, 0, Math.SQRT1_2], approach: [1, 0, 0], mask: [true, true, true, true, true, true] }],
    surfaces: [
        { name: "box/bottom", link: 7, pose: [0, 0, 0, 0, 0, 0, 1], kind: "contact", polygon: [[-0.03, -0.03, -0.045], [0.03, -0.03, -0.045], [0.03, 0.03, -0.045], [-0.03, 0.03, -0.045]] },
        { name: "room/top", link: 8, pose: [0, 0, 0, 0, 0, 0, 1], kind: "support", polygon: [[0.37, -0.62, TABLE], [0.83, -0.62, TABLE], [0.83, 0.62, TABLE], [0.37, 0.62, TABLE]] },
    ],
};

/** Kinds: path, refused (a path that the check refuses), scene, search, model. */
export function sample(kind = "path") {
    const blob = new Blob();
    const { meshes, links } = robot(blob);
    const all = corners();
    const [start, goal] = [all[0].q, all.at(-1).q];
    const isPath = kind === "path" || kind === "refused";
    const hasPath = isPath || kind === "search";
    const view = {
        format: "foliate.view/1",
        title: `sample ${kind}`,
        kind: kind === "refused" ? "path" : kind,
        warnings: ["package://arm/palm.dae is missing: arm/palm is drawn by its collision shapes"],
        facts: [["planner", "sequence, seed 7"], ["length", "4.1"]],
        meshes,
        parts: [{ name: "arm", kind: "robot" }, { name: "box", kind: "object" }, { name: "room", kind: "environment" }],
        links,
        joints: JOINTS,
        coordinates: COORDINATES,
        documents: DOCUMENTS,
        pairs: [[0, 2], [0, 7], [1, 8], [2, 8], [2, 9], [3, 9], [4, 9], [5, 7], [5, 8], [6, 7], [6, 8], [7, 9], [5, 9], [6, 9]],
        start,
        goal: kind === "model" ? null : goal,
        graph: kind === "model" ? null : sampleGraph(hasPath),
        path: isPath ? samplePath(blob, kind === "refused") : null,
        collisions: kind === "scene" ? [{ configuration: "goal", links: [7, 9], depth: 0.0032, point: [0.7, 0.1, 0.45], points: [[0.7, 0.1, 0.45], [0.68, 0.12, 0.45]], words: "box/body and room/ball collide, 3.20 mm deep" }] : [],
        violations: kind === "scene" ? [{ configuration: "start", words: "box lies on the table: off by 0.0123, allowed 0.0001", value: 0.0123, limit: 0.0001, links: [7], points: [[0.5, 0.2, 0.4523], [0.5, 0.2, 0.44]], angle: 0.05 }] : [],
        search: hasPath ? sampleSearch(blob, corners().map((corner) => corner.q)) : null,
    };
    return { view, binary: blob.bytes() };
}
