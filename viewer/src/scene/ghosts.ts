/** Start and goal as translucent bodies: only what moves, made when it is first shown. */
import { Group, Mesh, type Material } from "three";
import type { Model } from "../app/model";
import { Kinematics, matrixOf } from "../motion/kinematics";
import type { Bodies } from "./bodies";
import type { Geometries } from "./geometries";

export class Ghost {
    readonly root = new Group();
    private made = false;
    private wanted = false;

    constructor(
        private readonly model: Model,
        private readonly bodies: Bodies,
        private readonly geometries: Geometries,
        private readonly configuration: number[],
        private readonly material: Material,
    ) {
        model.configuration.watch(() => this.update());
    }

    show(on: boolean): void {
        this.wanted = on;
        this.update();
    }

    /** Hidden where the bodies stand just so: two pictures in one place flicker. */
    private update(): void {
        const shown = this.model.configuration.value;
        const on = this.wanted && this.configuration.some((value, i) => Math.abs(value - shown[i]!) > 1e-6);
        if (on) this.make();
        this.root.visible = on;
    }

    private make(): void {
        if (this.made) return;
        this.made = true;
        const kinematics = new Kinematics(this.model.view);
        kinematics.update(this.configuration);
        this.model.view.links.forEach((link, l) => {
            if (link.joint === null) return;
            for (const { shape, pose } of this.bodies.drawn(l)) {
                const mesh = new Mesh(this.geometries.of(shape), this.material);
                mesh.matrixAutoUpdate = false;
                mesh.matrix.multiplyMatrices(kinematics.worldFromLink[l]!, matrixOf(pose));
                // A ghost that stands where the body is does not flicker through it.
                mesh.renderOrder = 2;
                this.root.add(mesh);
            }
        });
    }
}
