// An arm of two links with a lift and two fingers, of which one follows the other; a box, a table, a pillar.
import { mesh } from "./blob.mjs";

export const L1 = 0.5;
export const L2 = 0.4;
export const TABLE = 0.4;
export const BOX = [0.06, 0.06, 0.09];
const O = [0, 0, 0, 0, 0, 0, 1];
const at = (x, y, z) => [x, y, z, 0, 0, 0, 1];

/** A beam along x that narrows: a mesh with sharp edges. */
function beam(length, a, b) {
    const ring = (x, r) => [x, -r, -r, x, r, -r, x, r, r, x, -r, r];
    const indices = [];
    for (let i = 0; i < 4; i++) {
        const j = (i + 1) % 4;
        indices.push(i, j, 4 + i, j, 4 + j, 4 + i);
    }
    indices.push(0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7);
    return { positions: [...ring(0, a), ...ring(length, b)], indices };
}

export const JOINTS = [
    { name: "arm/shoulder", part: 0, parent: null, parent_from_joint: at(0, 0, 0.62), type: "revolute", axis: [0, 0, 1], q: 0, v: 0, lower: [-2.8], upper: [2.8], velocity: 1.2 },
    { name: "arm/elbow", part: 0, parent: 0, parent_from_joint: at(L1, 0, 0.06), type: "revolute", axis: [0, 0, 1], q: 1, v: 1, lower: [-2.6], upper: [2.6], velocity: 1.5 },
    { name: "arm/lift", part: 0, parent: 1, parent_from_joint: at(L2, 0, 0), type: "prismatic", axis: [0, 0, -1], q: 2, v: 2, lower: [0], upper: [0.2], velocity: 0.4 },
    { name: "arm/finger", part: 0, parent: 2, parent_from_joint: at(0, 0, -0.1), type: "prismatic", axis: [0, 1, 0], q: 3, v: 3, lower: [0.02], upper: [0.07], velocity: 0.2 },
    { name: "arm/other_finger", part: 0, parent: 2, parent_from_joint: at(0, 0, -0.1), type: "prismatic", axis: [0, 1, 0], leader: 3, multiplier: -1, offset: 0, lower: [-0.07], upper: [-0.02] },
    { name: "box/root_joint", part: 1, parent: null, parent_from_joint: O, type: "freeflyer", q: 4, v: 4, lower: [-1, -1, 0, null, null, null, null], upper: [1, 1, 1.5, null, null, null, null] },
];

export const COORDINATES = ["arm/shoulder", "arm/elbow", "arm/lift", "arm/finger", ...["x", "y", "z", "qx", "qy", "qz", "qw"].map((c) => `box/${c}`)];

export function robot(blob) {
    const upper = beam(L1, 0.055, 0.04);
    const meshes = [mesh(blob, "upper.stl", upper.positions, upper.indices)];
    const grey = [0.72, 0.76, 0.8, 1];
    const blue = [0.22, 0.42, 0.68, 1];
    const both = (shape, pose, color) => ({ visual: [{ shape, pose, color }], collision: [{ shape, pose }] });
    const finger = (side) => both({ box: [0.03, 0.012, 0.1] }, at(0, side * 0.006, -0.03), blue);
    const turned = [0, Math.SQRT1_2, 0, Math.SQRT1_2];
    const links = [
        { name: "arm/base", part: 0, joint: null, joint_from_link: O, ...both({ cylinder: [0.09, 0.6] }, at(0, 0, 0.3), grey) },
        {
            name: "arm/upper",
            part: 0,
            joint: 0,
            joint_from_link: O,
            visual: [{ shape: { mesh: 0 }, pose: O, color: blue }],
            collision: [{ shape: { capsule: [0.062, L1] }, pose: [L1 / 2, 0, 0, ...turned] }],
        },
        { name: "arm/fore", part: 0, joint: 1, joint_from_link: O, ...both({ capsule: [0.045, L2] }, [L2 / 2, 0, 0, ...turned], grey) },
        { name: "arm/wrist", part: 0, joint: 2, joint_from_link: O, ...both({ cylinder: [0.03, 0.26] }, at(0, 0, 0.03), grey) },
        { name: "arm/palm", part: 0, joint: 2, joint_from_link: at(0, 0, -0.1), visual: [{ shape: { box: [0.1, 0.1, 0.02] }, pose: O, color: null, missing: "package://arm/palm.dae" }], collision: [{ shape: { box: [0.05, 0.17, 0.03] }, pose: at(0, 0, 0.02) }] },
        { name: "arm/finger", part: 0, joint: 3, joint_from_link: O, ...finger(1) },
        { name: "arm/other_finger", part: 0, joint: 4, joint_from_link: O, ...finger(-1) },
        { name: "box/body", part: 1, joint: 5, joint_from_link: O, visual: [], collision: [{ shape: { box: BOX }, pose: O }] },
        { name: "room/table", part: 2, joint: null, joint_from_link: O, visual: [], collision: [{ shape: { box: [0.5, 1.3, 0.04] }, pose: at(0.6, 0, TABLE - 0.02) }, { shape: { box: [0.06, 0.06, 0.36] }, pose: at(0.78, 0.55, 0.18) }, { shape: { box: [0.06, 0.06, 0.36] }, pose: at(0.78, -0.55, 0.18) }] },
        { name: "room/ball", part: 2, joint: null, joint_from_link: O, visual: [], collision: [{ shape: { sphere: 0.07 }, pose: at(0.74, 0.05, TABLE + 0.07) }] },
    ];
    return { meshes, links };
}

export const FROM = [0.55, -0.42];
export const TO = [0.55, 0.45];
/** The lift at which the hand is at a box on the table. */
export const DOWN = 0.62 + 0.06 - 0.1 - 0.045 - TABLE - BOX[2] / 2;

/** Shoulder and elbow that bring the wrist to a place. */
export function reach([x, y]) {
    const c = (x * x + y * y - L1 * L1 - L2 * L2) / (2 * L1 * L2);
    const elbow = -Math.acos(Math.min(Math.max(c, -1), 1));
    return [Math.atan2(y, x) - Math.atan2(L2 * Math.sin(elbow), L1 + L2 * Math.cos(elbow)), elbow];
}

/** The box where the hand holds it. */
export function carried(a) {
    const [s, e, lift] = a;
    const turn = s + e;
    const first = reach(FROM);
    const yaw = turn - first[0] - first[1];
    const [x, y] = [L1 * Math.cos(s) + L2 * Math.cos(turn), L1 * Math.sin(s) + L2 * Math.sin(turn)];
    return [x, y, TABLE + BOX[2] / 2 + DOWN - lift, 0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)];
}
