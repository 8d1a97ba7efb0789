/** Where the camera stands: presets, and fitting what matters into the picture. */
import { Box3, Mesh, Vector3, type Matrix4 } from "three";
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

    /** What matters: robots and objects along the path; the environment too where it is not much larger. */
    bounds(withEnvironment: boolean): Box3 {
        return new Box3().setFromPoints(this.corners(withEnvironment));
    }

    /** Corners of the boxes around all shapes, at a few times of the path. */
    private corners(withEnvironment: boolean): Vector3[] {
        const { view, kinematics, configuration, path } = this.model;
        const [acting, rest]: Vector3[][] = [[], []];
        const q = Float64Array.from(configuration.value);
        for (const time of path ? [0, 0.25, 0.5, 0.75, 1].map((s) => s * path.duration) : [null]) {
            if (time !== null) path!.configurationAt(time, q);
            kinematics.update(q);
            this.bodies.links.forEach((group, l) => {
                const isEnvironment = view.parts[view.links[l]!.part]!.kind === "environment";
                // What never moves is asked once.
                if (isEnvironment && view.links[l]!.joint === null && rest!.length > 0 && time !== null && time > 0) return;
                for (const child of group.children) {
                    if (child instanceof Mesh) cornersOf(child, kinematics.worldFromLink[l]!, isEnvironment ? rest! : acting!);
                }
            });
        }
        kinematics.update(configuration.value);
        if (acting!.length === 0) return rest!;
        const all = [...acting!, ...rest!];
        return withEnvironment && diagonal(all) < 2.2 * diagonal(acting!) ? all : acting!;
    }

    /** Looks at the scene from a direction, or from where the camera is. */
    look(name: ViewName | null, animated = true): void {
        const { camera, controls } = this.stage;
        const direction = name ? new Vector3(...VIEWS[name]) : camera.position.clone().sub(controls.target);
        const { centre, distance } = this.frame(this.corners(true), direction.normalize());
        this.moveTo(centre, centre.clone().addScaledVector(direction, distance), animated);
    }

    /** The middle of what is seen from a direction, and the least distance from which all of it is. */
    private frame(points: Vector3[], direction: Vector3): { centre: Vector3; distance: number } {
        if (points.length === 0) return { centre: new Vector3(), distance: 3 };
        const { camera } = this.stage;
        const side = new Vector3().crossVectors(camera.up, direction).normalize();
        const up = new Vector3().crossVectors(direction, side);
        const tanY = Math.tan((camera.fov * Math.PI) / 360) * 0.92;
        const tanX = tanY * Math.max(camera.aspect, 0.2);
        const centre = new Vector3();
        for (const axis of [side, up, direction]) {
            const along = points.map((point) => point.dot(axis));
            const [low, high] = along.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity] as [number, number]);
            centre.addScaledVector(axis, (low + high) / 2);
        }
        const from = new Vector3();
        const distance = points.reduce((needed, point) => {
            from.subVectors(point, centre);
            const depth = from.dot(direction);
            return Math.max(needed, depth + Math.abs(from.dot(side)) / tanX, depth + Math.abs(from.dot(up)) / tanY);
        }, 0.05);
        return { centre, distance };
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

function cornersOf(mesh: Mesh, worldFromLink: Matrix4, out: Vector3[]): void {
    if (!mesh.geometry.boundingBox) mesh.geometry.computeBoundingBox();
    const { min, max } = mesh.geometry.boundingBox!;
    for (let i = 0; i < 8; i++) {
        const corner = new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
        out.push(corner.applyMatrix4(mesh.matrix).applyMatrix4(worldFromLink));
    }
}

function diagonal(points: Vector3[]): number {
    return new Box3().setFromPoints(points).getSize(new Vector3()).length();
}
