/** Start and goal as translucent bodies: what moves and stands elsewhere now. Made when it is first shown. */
import { Group, Mesh, type Material, type Matrix4 } from "three";
import type { Model } from "../app/model";
import { Kinematics, matrixOf } from "../motion/kinematics";
import type { Bodies } from "./bodies";
import type { Geometries } from "../shape/geometries";

/** Metres, and parts of a turn, below which two pictures of a link in one place would flicker. */
const SAME = 2e-3;

export class Ghost {
    readonly root = new Group();
    private links: { link: number; group: Group }[] | null = null;

    constructor(
        private readonly model: Model,
        private readonly bodies: Bodies,
        private readonly geometries: Geometries,
        private readonly configuration: number[],
        private readonly material: Material,
    ) {
        this.root.visible = false;
        model.configuration.watch(() => this.update());
    }

    show(on: boolean): void {
        this.root.visible = on;
        this.update();
    }

    private update(): void {
        if (!this.root.visible) return;
        this.links ??= this.make();
        const shown = this.model.kinematics.worldFromLink;
        for (const { link, group } of this.links) group.visible = !isSame(group.matrix, shown[link]!);
    }

    private make(): { link: number; group: Group }[] {
        const kinematics = new Kinematics(this.model.view);
        kinematics.update(this.configuration);
        return this.model.view.links.flatMap(({ joint }, link) => {
            if (joint === null) return [];
            const group = new Group();
            group.matrixAutoUpdate = false;
            group.matrix.copy(kinematics.worldFromLink[link]!);
            for (const { shape, pose } of this.bodies.drawn(link)) {
                const mesh = new Mesh(this.geometries.of(shape), this.material);
                mesh.matrixAutoUpdate = false;
                mesh.matrix.copy(matrixOf(pose));
                mesh.renderOrder = 2;
                group.add(mesh);
            }
            this.root.add(group);
            return [{ link, group }];
        });
    }
}

function isSame(a: Matrix4, b: Matrix4): boolean {
    return a.elements.every((value, i) => Math.abs(value - b.elements[i]!) < SAME);
}
