/** Lines between points of the world: the closest pair, a collision's depth, a measurement. */
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";
import { FAILURE } from "../app/colours";
import type { Model } from "../app/model";
import { length } from "../data/names";
import { indexAt } from "../motion/path";
import type { Labels } from "./labels";

const BALL = new SphereGeometry(1, 16, 12);

/** Two balls, a line, and a text in the middle. */
export class Dumbbell {
    readonly root = new Group();
    private readonly line: Line<BufferGeometry, LineBasicMaterial>;
    private readonly balls: [Mesh, Mesh];
    private readonly middle = new Vector3();
    private readonly label: HTMLElement;

    constructor(labels: Labels, colour: string, radius: number, kind: string) {
        const options = { color: colour, depthTest: false, transparent: true };
        const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(6), 3));
        this.line = new Line(geometry, new LineBasicMaterial(options));
        const material = new MeshBasicMaterial(options);
        this.balls = [new Mesh(BALL, material), new Mesh(BALL, material)];
        for (const ball of this.balls) ball.scale.setScalar(radius);
        this.line.frustumCulled = false;
        this.root.add(this.line, ...this.balls);
        this.root.traverse((object) => (object.renderOrder = 20));
        this.root.visible = false;
        this.label = labels.text("", `label ${kind}`, null, this.middle, () => this.root.visible && this.label.textContent !== "");
    }

    between(a: Vector3, b: Vector3, text: string): void {
        const position = this.line.geometry.getAttribute("position") as BufferAttribute;
        position.setXYZ(0, a.x, a.y, a.z);
        position.setXYZ(1, b.x, b.y, b.z);
        position.needsUpdate = true;
        this.balls[0].position.copy(a);
        this.balls[1].position.copy(b);
        this.middle.lerpVectors(a, b, 0.5);
        this.label.textContent = text;
        this.root.visible = true;
    }

    hide(): void {
        this.root.visible = false;
    }
}

/** The closest pair at the time, from the clearance of the path. */
export function closestPair(model: Model, labels: Labels, radius: number): Group {
    const pair = new Dumbbell(labels, "#16a085", radius, "label-clearance");
    const [a, b] = [new Vector3(), new Vector3()];
    const update = (): void => {
        const clearance = model.path?.clearance;
        if (!clearance || !model.switches.clearance.value || model.posed.value) return pair.hide();
        const k = nearest(clearance.times, model.time.value);
        a.fromArray(clearance.points, 6 * k);
        b.fromArray(clearance.points, 6 * k + 3);
        pair.between(a, b, length(clearance.values[k] ?? 0));
    };
    model.configuration.watch(update);
    model.switches.clearance.watch(update);
    return pair.root;
}

export function nearest(times: ArrayLike<number>, t: number): number {
    const k = indexAt(times, t);
    return k + 1 < times.length && times[k + 1]! - t < t - times[k]! ? k + 1 : k;
}

/** Points of what is marked: a collision or a violation. */
export function markPoints(model: Model, labels: Labels, radius: number): Group {
    const pair = new Dumbbell(labels, FAILURE, radius, "label-failure");
    model.mark.watch((mark) => {
        const [first, second] = mark?.points ?? [];
        if (!mark || !first) return pair.hide();
        const a = new Vector3(...first);
        pair.between(a, second ? new Vector3(...second) : a, mark.number);
    });
    return pair.root;
}
