/** What a person clicks in the scene: a link is named, a node of the roadmap is shown, two points are measured. */
import { Raycaster, Vector2, Vector3 } from "three";
import type { Model } from "../app/model";
import { Signal } from "../app/signal";
import { length, linkName } from "../data/names";
import type { Bodies } from "./bodies";
import type { Labels } from "./labels";
import { Dumbbell } from "./marks";
import type { Stage } from "./stage";

/** Pixels that a pointer may move between down and up of a click. */
const STILL = 5;

export class Picking {
    /** What was clicked last, in words. */
    readonly picked = new Signal("");
    readonly measured = new Signal("");
    readonly measurement: Dumbbell;
    /** Offered a ray first; answers whether it took the click. */
    readonly takers: ((ray: Raycaster) => boolean)[] = [];
    private readonly ray = new Raycaster();
    private first: Vector3 | null = null;
    private readonly radius: number;

    constructor(
        private readonly stage: Stage,
        private readonly model: Model,
        private readonly bodies: Bodies,
        labels: Labels,
        scale: number,
    ) {
        this.radius = scale * 0.004;
        this.measurement = new Dumbbell(labels, "#8e44ad", this.radius, "label-measure");
        this.ray.params.Points.threshold = scale * 0.008;
        const canvas = stage.renderer.domElement;
        let down = new Vector2();
        canvas.addEventListener("pointerdown", (event) => down.set(event.clientX, event.clientY));
        canvas.addEventListener("pointerup", (event) => {
            if (event.button === 0 && down.distanceTo(new Vector2(event.clientX, event.clientY)) < STILL) this.click(event);
        });
        model.measuring.watch((on) => {
            canvas.classList.toggle("measuring", on);
            this.first = null;
            this.measurement.hide();
            this.measured.set(on ? "Click the first point." : "");
            stage.invalidate();
        });
    }

    private click(event: PointerEvent): void {
        const box = this.stage.renderer.domElement.getBoundingClientRect();
        const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
        this.ray.setFromCamera(at, this.stage.camera);
        if (!this.model.measuring.value && this.takers.some((taker) => taker(this.ray))) return;
        const hit = this.ray.intersectObjects(this.bodies.shown(), false)[0];
        const link = this.bodies.linkOf(hit?.object ?? null);
        const name = link === null ? "" : linkName(this.model.view, link);
        if (this.model.measuring.value) {
            if (hit) this.measure(hit.point.clone(), name);
        } else {
            this.picked.set(name);
        }
        this.stage.invalidate();
    }

    private measure(point: Vector3, name: string): void {
        if (!this.first) {
            this.first = point;
            this.measurement.between(point, point, "");
            this.measured.set(`First point on ${name}. Click the second point.`);
            return;
        }
        const d = point.clone().sub(this.first);
        this.measurement.between(this.first, point, length(d.length()));
        const parts = (["x", "y", "z"] as const).map((axis) => `${axis} ${length(d[axis])}`).join(", ");
        this.measured.set(`${length(d.length())} (${parts}). Click to measure again.`);
        this.first = null;
    }
}
