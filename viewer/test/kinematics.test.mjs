// Poses, interpolation and contacts against values computed by hand.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";
import { sample } from "./sample.mjs";

const { Kinematics, neutral, poseOf, Path, indexAt, Arrays, Roadmap, Contacts, trianglesTouch, TriangleTree, treesTouch, BoxGeometry, Matrix4 } = await load(`
    export { Kinematics, neutral, poseOf } from "./src/motion/kinematics";
    export { Path, indexAt } from "./src/motion/path";
    export { Roadmap } from "./src/motion/roadmap";
    export { Arrays } from "./src/data/read";
    export { trianglesTouch } from "./src/collide/triangles";
    export { TriangleTree, treesTouch } from "./src/collide/triangle_tree";
    export { Contacts } from "./src/collide/contacts";
    export { BoxGeometry, Matrix4 } from "three";
`);

const O = [0, 0, 0, 0, 0, 0, 1];
const H = Math.SQRT1_2;

function joint(more) {
    return { name: "j", part: 0, parent: null, parent_from_joint: O, axis: [0, 0, 1], q: 0, ...more };
}

/** The pose of a link on the last joint. */
function pose(joints, q, joint_from_link = O) {
    const view = { joints, links: [{ name: "l", part: 0, joint: joints.length - 1, joint_from_link, visual: [], collision: [] }], coordinates: q.map(String) };
    const kinematics = new Kinematics(view);
    kinematics.update(q);
    return poseOf(kinematics.worldFromLink[0]);
}

function near(actual, expected, tolerance = 1e-12) {
    assert.equal(actual.length, expected.length);
    // A quaternion and its opposite are one rotation.
    const sign = actual.length === 7 && actual[6] * expected[6] + actual[5] * expected[5] + actual[4] * expected[4] + actual[3] * expected[3] < 0 ? -1 : 1;
    actual.forEach((value, i) => assert.ok(Math.abs((i > 2 ? sign : 1) * value - expected[i]) <= tolerance, `${actual} is not ${expected}`));
}

test("a revolute joint turns about its axis in the joint's frame", () => {
    near(pose([joint({ type: "revolute", parent_from_joint: [1, 2, 3, 0, 0, 0, 1] })], [Math.PI / 2], [0.5, 0, 0, 0, 0, 0, 1]), [1, 2.5, 3, 0, 0, H, H]);
    // The joint's frame is turned by a quarter about x: its z is the world's -y.
    near(pose([joint({ type: "revolute", parent_from_joint: [0, 0, 0, H, 0, 0, H] })], [Math.PI / 2], [1, 0, 0, 0, 0, 0, 1]), [0, 0, 1, 0.5, -0.5, 0.5, 0.5]);
});

test("a prismatic joint moves along its axis", () => {
    near(pose([joint({ type: "prismatic", axis: [0, 0, -1], parent_from_joint: [0, 0, 1, H, 0, 0, H] })], [0.25]), [0, 0.25, 1, H, 0, 0, H]);
});

test("a planar joint moves in its plane, then turns", () => {
    near(pose([joint({ type: "planar" })], [2, 3, Math.PI], [1, 0, 0, 0, 0, 0, 1]), [1, 3, 0, 0, 0, 1, 0]);
});

test("a free-flyer is its pose, whatever the length of its quaternion", () => {
    near(pose([joint({ type: "freeflyer" })], [1, 2, 3, 0, 0, 2, 2]), [1, 2, 3, 0, 0, H, H]);
});

test("a follower takes the leader's value by factor and offset, before or after it in the list", () => {
    const leader = joint({ type: "revolute" });
    const follower = joint({ type: "prismatic", axis: [1, 0, 0], q: null, leader: 0, multiplier: -2, offset: 0.5 });
    near(pose([leader, follower], [0.75]), [-1, 0, 0, 0, 0, 0, 1]);
    const first = joint({ type: "prismatic", axis: [1, 0, 0], q: null, leader: 1, multiplier: -2, offset: 0.5 });
    const view = { joints: [first, leader], links: [{ name: "l", part: 0, joint: 0, joint_from_link: O }], coordinates: ["j"] };
    const kinematics = new Kinematics(view);
    kinematics.update([0.75]);
    near(poseOf(kinematics.worldFromLink[0]), [-1, 0, 0, 0, 0, 0, 1]);
});

test("joints follow their parents, and a chain gives what the whole gives", () => {
    const { view } = sample("path");
    const kinematics = new Kinematics(view);
    const q = [Math.PI / 2, -Math.PI / 2, 0.1, 0.05, 9, 8, 7, 0, 0, 0, 1];
    kinematics.update(q);
    const link = (name) => view.links.findIndex((l) => l.name === name);
    // Shoulder at height 0.62, upper arm 0.5 along y, elbow 0.06 higher, forearm 0.4 along x, lift down by 0.1.
    near(poseOf(kinematics.worldFromLink[link("arm/wrist")]), [0.4, 0.5, 0.58, 0, 0, 0, 1]);
    near(poseOf(kinematics.worldFromLink[link("arm/finger")]), [0.4, 0.55, 0.48, 0, 0, 0, 1]);
    near(poseOf(kinematics.worldFromLink[link("arm/other_finger")]), [0.4, 0.45, 0.48, 0, 0, 0, 1]);
    near(poseOf(kinematics.worldFromLink[link("box/body")]), [9, 8, 7, 0, 0, 0, 1]);
    const other = new Kinematics(view);
    near(poseOf(other.updateChain(link("arm/finger"), q)), [0.4, 0.55, 0.48, 0, 0, 0, 1]);
});

test("the neutral configuration keeps the limits", () => {
    const { view } = sample("model");
    assert.deepEqual([...neutral(view)], [0, 0, 0, 0.02, 0, 0, 0, 0, 0, 0, 1]);
});

function pathOf(joints, times, configurations) {
    const numbers = new Float32Array([...times, ...configurations.flat()]);
    const view = { joints, coordinates: configurations[0].map(String) };
    const data = { timed: true, duration: times.at(-1), times: 0, configurations: 4 * times.length, samples: times.length, segments: [{ from: 0, to: 1 }, { from: 1, to: 2 }] };
    return new Path(view, data, new Arrays(numbers.buffer));
}

test("between samples numbers go straight, planar angles too, free-flyers turn evenly", () => {
    const flyer = joint({ type: "freeflyer" });
    const path = pathOf([flyer], [0, 2], [[0, 0, 0, 0, 0, 0, 1], [2, 0, 4, 0, 0, 1, 0]]);
    const out = new Float64Array(7);
    path.configurationAt(0.5, out);
    const s = Math.PI / 8;
    near([...out], [0.5, 0, 1, 0, 0, Math.sin(s), Math.cos(s)], 1e-6);
    const planar = pathOf([joint({ type: "planar" })], [0, 1], [[0, 0, 3], [1, 0, -3]]);
    const three = new Float64Array(3);
    planar.configurationAt(0.5, three);
    near([...three], [0.5, 0, 0], 1e-6);
    planar.configurationAt(5, three);
    near([three[0], three[1]], [1, 0]);
});

test("a box in the place of a missing mesh touches nothing", () => {
    const shape = (missing) => ({ shape: { box: [1, 1, 1] }, pose: O, missing });
    const touching = (missing) => {
        const link = (name, lost) => ({ name, part: 0, joint: null, joint_from_link: O, visual: [], collision: [shape(lost)] });
        const view = { joints: [], links: [link("a"), link("b", missing)], coordinates: [], pairs: [[0, 1]] };
        const kinematics = new Kinematics(view);
        kinematics.update([]);
        // Turned, so that no faces lie in one plane.
        view.links[1].collision[0].pose = [0.2, 0.1, 0.3, 0, 0, Math.sin(0.2), Math.cos(0.2)];
        return new Contacts(view, kinematics, { of: () => new BoxGeometry(1, 1, 1) }).now();
    };
    assert.deepEqual(touching(null), [[0, 1]]);
    assert.deepEqual(touching("lost.stl"), []);
});

test("segments and samples are found by time", () => {
    assert.deepEqual([-1, 0, 0.5, 1, 1.5, 9].map((t) => indexAt([0, 1, 2], t)), [0, 0, 0, 1, 1, 2]);
    assert.equal(indexAt([], 1), 0);
    const path = pathOf([joint({ type: "revolute" })], [0, 2], [[0], [1]]);
    assert.deepEqual([0, 0.99, 1, 2].map((t) => path.segmentAt(t)), [0, 0, 1, 1]);
});

test("data that is cut short is an error", () => {
    assert.throws(() => new Arrays(new ArrayBuffer(8)).float32(0, 3), /cut short/);
});

test("components of a roadmap are numbered by size", () => {
    const view = { joints: [joint({ type: "revolute" })], coordinates: ["j"], links: [] };
    const bytes = new ArrayBuffer(64);
    const edges = new Uint32Array(bytes, 0, 4);
    edges.set([1, 2, 2, 3]);
    const data = { nodes: 16, count: 4, tree: 32, state: 40, step: 48, edges: 0, edge_count: 2 };
    const roadmap = new Roadmap(view, data, new Arrays(bytes));
    assert.deepEqual([0, 1, 2, 3].map((node) => roadmap.group(node, "component")), [1, 0, 0, 0]);
    assert.deepEqual(roadmap.groups("component"), [[0, 3], [1, 1]]);
});

test("triangles touch or not", () => {
    const flat = Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0);
    const at = (...corners) => Float64Array.from(corners);
    assert.ok(trianglesTouch(flat, at(0.2, 0.2, -1, 0.2, 0.2, 1, 0.3, 0.2, 1)), "one passes through the other");
    assert.ok(!trianglesTouch(flat, at(0.2, 0.2, 0.1, 0.2, 0.2, 1, 0.3, 0.2, 1)), "one is above the other");
    assert.ok(trianglesTouch(flat, at(0.1, 0.1, 0, 0.2, 0.1, 0, 0.1, 0.2, 0)), "one lies in the other");
    assert.ok(!trianglesTouch(flat, at(0.8, 0.8, 0, 1.8, 0.8, 0, 0.8, 1.8, 0)), "both lie in one plane, apart");
});

test("boxes touch where they overlap", () => {
    const box = new TriangleTree(new BoxGeometry(1, 1, 1, 3, 3, 3));
    const at = (x, turn) => new Matrix4().makeRotationZ(turn).setPosition(x, 0, 0);
    assert.ok(treesTouch(box, at(0, 0), box, at(0.9, 0.1)));
    assert.ok(!treesTouch(box, at(0, 0), box, at(1.05, 0)));
    // Turned by an eighth the corner reaches 0.707.
    assert.ok(treesTouch(box, at(0, 0), box, at(1.2, Math.PI / 4)));
    assert.ok(!treesTouch(box, at(0, 0), box, at(1.21, Math.PI / 4)));
});
