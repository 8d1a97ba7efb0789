/** Where the camera stands: presets, and fitting what matters into the picture. */
import { Box3, Mesh, Ray, Vector3, type Matrix4 } from "three";
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

/** An environment so many times as large as what moves is not fitted into the picture. */
const MUCH_LARGER = 1.6;

const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class Views {
    private moving = 0;

    constructor(
        private readonly stage: Stage,
        private readonly model: Model,
        private readonly bodies: Bodies,
    ) {
        const [acting, rest] = this.allCorners();
        this.stage.setBounds(this.bounds(true), new Box3().setFromPoints([...acting, ...rest]).min.z);
        this.look("clearest", false);
    }

    /** What matters: robots and objects along the path; the environment too where it is not much larger. */
    bounds(withEnvironment: boolean): Box3 {
        return new Box3().setFromPoints(this.corners(withEnvironment));
    }

    private corners(withEnvironment: boolean): Vector3[] {
        const [acting, rest] = this.allCorners();
        if (acting.length === 0) return rest;
        const all = [...acting, ...rest];
        return withEnvironment && diagonal(all) < MUCH_LARGER * diagonal(acting) ? all : acting;
    }

    /** Corners of the boxes around shapes, wherever the document puts them: of robots and objects, of the environment. */
    private allCorners(): [Vector3[], Vector3[]] {
        const { view, kinematics, configuration } = this.model;
        const [acting, rest]: [Vector3[], Vector3[]] = [[], []];
        this.configurations().forEach((q, i) => {
            kinematics.update(q);
            this.bodies.links.forEach((group, l) => {
                const link = view.links[l]!;
                // What never moves is asked once.
                if (i > 0 && link.joint === null) return;
                const out = view.parts[link.part]!.kind === "environment" ? rest : acting;
                for (const child of group.children) if (child instanceof Mesh) cornersOf(child, kinematics.worldFromLink[l]!, out);
            });
        });
        kinematics.update(configuration.value);
        return [acting, rest];
    }

    /** What is shown now, start and goal, a few places of the path. */
    private configurations(): ArrayLike<number>[] {
        const { view, configuration, path } = this.model;
        const along = [0, 0.25, 0.5, 0.75, 1].map((s) => {
            const q = Float64Array.from(configuration.value);
            path?.configurationAt(s * path.duration, q);
            return q;
        });
        return [...(path ? along : [configuration.value]), ...(view.start ? [view.start] : []), ...(view.goal ? [view.goal] : [])];
    }

    /** The corner from which the environment hides least of what moves; boxes stand for shapes. */
    private clearest(): Vector3 {
        const { view, kinematics } = this.model;
        const meshesOf = (kinds: string[]): [Mesh, number][] =>
            this.bodies.links.flatMap((group, l) => {
                const meshes = kinds.includes(view.parts[view.links[l]!.part]!.kind) ? group.children.filter((child) => child instanceof Mesh) : [];
                return meshes.map((mesh): [Mesh, number] => [mesh, l]);
            });
        const walls = meshesOf(["environment"]).map(([mesh, l]) => {
            const shapeFromWorld = kinematics.worldFromLink[l]!.clone().multiply(mesh.matrix).invert();
            return { shapeFromWorld, box: mesh.geometry.boundingBox! };
        });
        const points = meshesOf(["robot", "object"]).map(([mesh, l]) => mesh.geometry.boundingBox!.getCenter(new Vector3()).applyMatrix4(mesh.matrix).applyMatrix4(kinematics.worldFromLink[l]!));
        const corners = this.corners(true);
        const [x, y, z] = VIEWS.Corner;
        const directions = [[x, y], [x, -y], [-x, y], [-x, -y]].map(([a, b]) => new Vector3(a, b, z).normalize());
        const hidden = directions.map((direction) => {
            const { centre, distance } = this.frame(corners, direction);
            const eye = centre.addScaledVector(direction, distance);
            return points.filter((point) => walls.some(({ shapeFromWorld, box }) => isBetween(box, eye.clone().applyMatrix4(shapeFromWorld), point.clone().applyMatrix4(shapeFromWorld)))).length;
        });
        const best = hidden.indexOf(Math.min(...hidden));
        // The usual corner, unless another shows clearly more.
        return directions[hidden[0]! - hidden[best]! > 0.15 * points.length ? best : 0]!;
    }

    /** Looks at the scene from a direction, from the clearest corner, or from where the camera is. */
    look(name: ViewName | "clearest" | null, animated = true): void {
        const { camera, controls } = this.stage;
        const direction = name === "clearest" ? this.clearest() : name ? new Vector3(...VIEWS[name]) : camera.position.clone().sub(controls.target);
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

/** Whether a box lies between two points, in its own frame. */
function isBetween(box: Box3, from: Vector3, to: Vector3): boolean {
    const hit = new Ray(from, to.clone().sub(from).normalize()).intersectBox(box, new Vector3());
    return hit !== null && hit.distanceTo(from) < to.distanceTo(from) - 1e-3;
}

function diagonal(points: Vector3[]): number {
    return new Box3().setFromPoints(points).getSize(new Vector3()).length();
}
