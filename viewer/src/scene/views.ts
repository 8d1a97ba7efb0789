/** Where the camera stands: presets, and fitting what matters into the picture. */
import { Box3, Vector3 } from "three";
import type { Model } from "../app/model";
import type { Bodies } from "./bodies";
import type { Stage } from "./stage";

/** Directions from what is looked at to the camera. Robots look along x, y is to their left. */
export const VIEWS = {
    Corner: [0.75, -0.95, 0.6],
    Front: [1, 0, 0.12],
    Back: [-1, 0, 0.12],
    Left: [0, 1, 0.12],
    Right: [0, -1, 0.12],
    Top: [0, -0.001, 1],
} as const;
export type ViewName = keyof typeof VIEWS;

const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class Views {
    private moving = 0;

    constructor(
        private readonly stage: Stage,
        private readonly model: Model,
        private readonly bodies: Bodies,
    ) {
        this.stage.setBounds(this.bounds(true));
        this.look("Corner", false);
    }

    /** Robots and objects along the path; the environment too where it is not much larger. */
    bounds(withEnvironment: boolean): Box3 {
        const { view, kinematics, configuration, path } = this.model;
        const [acting, all] = [new Box3(), new Box3()];
        const times = path ? [0, 0.25, 0.5, 0.75, 1].map((s) => s * path.duration) : [null];
        const q = Float64Array.from(configuration.value);
        const box = new Box3();
        for (const time of times) {
            if (time !== null) path!.configurationAt(time, q);
            kinematics.update(q);
            this.bodies.links.forEach((group, l) => {
                for (const child of group.children) {
                    if (!("geometry" in child)) continue;
                    const mesh = child as unknown as { geometry: { boundingBox: Box3 | null; computeBoundingBox(): void }; matrix: typeof group.matrix };
                    if (!mesh.geometry.boundingBox) mesh.geometry.computeBoundingBox();
                    box.copy(mesh.geometry.boundingBox!).applyMatrix4(mesh.matrix).applyMatrix4(kinematics.worldFromLink[l]!);
                    all.union(box);
                    if (view.parts[view.links[l]!.part]!.kind !== "environment") acting.union(box);
                }
            });
        }
        kinematics.update(configuration.value);
        if (acting.isEmpty()) return all;
        const [a, b] = [acting.getSize(new Vector3()).length(), all.getSize(new Vector3()).length()];
        return withEnvironment && b < 2.2 * a ? all : acting;
    }

    /** Looks at the scene from a direction, or from where the camera is. */
    look(name: ViewName | null, animated = true): void {
        const bounds = this.bounds(true);
        const centre = bounds.isEmpty() ? new Vector3() : bounds.getCenter(new Vector3());
        const { camera, controls } = this.stage;
        const direction = name ? new Vector3(...VIEWS[name]) : camera.position.clone().sub(controls.target);
        direction.normalize();
        this.moveTo(centre, centre.clone().addScaledVector(direction, this.distance(bounds, centre, direction)), animated);
    }

    /** The least distance from which all corners of a box are seen. */
    private distance(bounds: Box3, centre: Vector3, direction: Vector3): number {
        if (bounds.isEmpty()) return 3;
        const { camera } = this.stage;
        const side = new Vector3().crossVectors(camera.up, direction).normalize();
        const up = new Vector3().crossVectors(direction, side);
        const tanY = Math.tan((camera.fov * Math.PI) / 360) * 0.86;
        const tanX = tanY * Math.max(camera.aspect, 0.2);
        let needed = 0.1;
        for (let i = 0; i < 8; i++) {
            const corner = new Vector3(
                i & 1 ? bounds.max.x : bounds.min.x,
                i & 2 ? bounds.max.y : bounds.min.y,
                i & 4 ? bounds.max.z : bounds.min.z,
            ).sub(centre);
            const depth = corner.dot(direction);
            needed = Math.max(needed, depth + Math.abs(corner.dot(side)) / tanX, depth + Math.abs(corner.dot(up)) / tanY);
        }
        return needed;
    }

    private moveTo(target: Vector3, position: Vector3, animated: boolean): void {
        const { camera, controls } = this.stage;
        cancelAnimationFrame(this.moving);
        const [target0, position0] = [controls.target.clone(), camera.position.clone()];
        const begin = performance.now();
        const frame = (): void => {
            const s = animated && !calm.matches ? Math.min((performance.now() - begin) / 280, 1) : 1;
            const eased = s * s * (3 - 2 * s);
            controls.target.lerpVectors(target0, target, eased);
            camera.position.lerpVectors(position0, position, eased);
            controls.update();
            this.stage.invalidate();
            if (s < 1) this.moving = requestAnimationFrame(frame);
        };
        frame();
    }
}
