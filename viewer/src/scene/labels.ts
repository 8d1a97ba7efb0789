/** Texts at places of the scene: names of features, distances. Elements over the canvas, moved before each frame. */
import { Vector3 } from "three";
import { h } from "../app/dom";
import type { Model, SwitchName } from "../app/model";
import type { Stage } from "./stage";

/** More names than this hide the scene. */
const MOST = 120;

interface Label {
    element: HTMLElement;
    link: number | null;
    at: Vector3;
    shown: () => boolean;
}

export class Labels {
    private readonly layer = h("div", { class: "labels", "aria-hidden": "true" });
    private readonly labels: Label[] = [];
    private readonly point = new Vector3();

    constructor(
        private readonly model: Model,
        private readonly stage: Stage,
    ) {
        stage.element.append(this.layer);
        stage.beforeFrame.push(() => this.place());
    }

    /** The name of a feature, shown where both its kind and names are switched on. */
    add(text: string, link: number, at: Vector3, kind: SwitchName): void {
        if (this.labels.length >= MOST) return;
        const { switches } = this.model;
        this.text(text, "label", link, at, () => switches.names.value && switches[kind].value);
    }

    /** A text at a place in the frame of a link, or in the world. */
    text(text: string, kind: string, link: number | null, at: Vector3, shown: () => boolean): HTMLElement {
        const element = h("span", { class: kind }, text);
        this.layer.append(element);
        this.labels.push({ element, link, at, shown });
        return element;
    }

    private place(): void {
        const { clientWidth, clientHeight } = this.stage.element;
        this.stage.camera.updateMatrixWorld();
        for (const { element, link, at, shown } of this.labels) {
            let visible = shown();
            if (visible) {
                this.point.copy(at);
                if (link !== null) this.point.applyMatrix4(this.model.kinematics.worldFromLink[link]!);
                this.point.project(this.stage.camera);
                visible = this.point.z < 1 && Math.abs(this.point.x) < 1 && Math.abs(this.point.y) < 1;
                const x = ((this.point.x + 1) / 2) * clientWidth;
                const y = ((1 - this.point.y) / 2) * clientHeight;
                element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
            }
            element.style.display = visible ? "" : "none";
        }
    }
}
