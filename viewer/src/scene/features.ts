/** Grippers, handles with approach arrows and contact surfaces, each on its link; frames of links. */
import {
    ArrowHelper,
    BufferGeometry,
    DoubleSide,
    Float32BufferAttribute,
    Group,
    Line,
    LineBasicMaterial,
    LineLoop,
    LineSegments,
    Mesh,
    MeshBasicMaterial,
    ShapeUtils,
    Vector2,
    Vector3,
} from "three";
import type { Model, SwitchName } from "../app/model";
import type { Pose, Vec3 } from "../data/document";
import { matrixOf } from "../motion/kinematics";
import type { Bodies } from "./bodies";
import type { Labels } from "./labels";

const GRIPPER = "#1b7fb8";
const HANDLE = "#d9711c";
const SURFACE: Record<string, string> = { contact: "#2f9e6b", support: "#3f72af" };

const ORIGIN: Pose = [0, 0, 0, 0, 0, 0, 1];
/** x red, y green, z blue, of unit length. */
const TRIAD = new BufferGeometry()
    .setAttribute("position", new Float32BufferAttribute([0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1], 3))
    .setAttribute("color", new Float32BufferAttribute([0.85, 0.2, 0.2, 0.85, 0.2, 0.2, 0.15, 0.6, 0.25, 0.15, 0.6, 0.25, 0.2, 0.4, 0.9, 0.2, 0.4, 0.9], 3));
const TRIAD_LINES = new LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true });

export class FeaturesLayer {
    private readonly groups: Group[] = [];

    constructor(
        private readonly model: Model,
        private readonly bodies: Bodies,
        private readonly labels: Labels,
        private readonly scale: number,
    ) {
        const features = model.view.documents ?? {};
        this.layer("grippers", features.grippers ?? [], (g) => this.gripper(g.pose));
        this.layer("handles", features.handles ?? [], (hd) => this.handle(hd.pose, hd.approach ?? null));
        this.layer("surfaces", features.surfaces ?? [], (s) => surface(s.polygon, SURFACE[s.kind] ?? SURFACE["contact"]!));
        this.linkFrames();
    }

    /** One group a feature, on its link, shown by a switch; its name by a label. */
    private layer<T extends { name: string; link: number; pose: Pose; polygon?: Vec3[] }>(
        name: SwitchName,
        features: T[],
        draw: (feature: T) => Group,
    ): void {
        const groups = features.map((feature) => {
            const group = draw(feature);
            group.userData["feature"] = feature.name;
            this.bodies.links[feature.link]?.add(group);
            const at = feature.polygon ? centreOf(feature.polygon) : feature.pose.slice(0, 3);
            this.labels.add(feature.name, feature.link, new Vector3(at[0], at[1], at[2]), name);
            return group;
        });
        this.groups.push(...groups);
        this.model.switches[name].watch((on) => groups.forEach((group) => (group.visible = on)));
    }

    /** The frames of links, small, and that of the world, on the switch of frames. */
    private linkFrames(): void {
        const world = this.triad(ORIGIN, 3);
        this.bodies.root.add(world);
        const groups = this.bodies.links.map((link) => {
            const group = this.triad(ORIGIN, 0.6);
            link.add(group);
            return group;
        });
        this.model.switches.frames.watch((on) => [world, ...groups].forEach((group) => (group.visible = on)));
    }

    private triad(pose: Pose, factor: number): Group {
        const group = placed(pose);
        const lines = new LineSegments(TRIAD, TRIAD_LINES);
        lines.scale.setScalar(this.scale * 0.06 * factor);
        lines.renderOrder = 5;
        group.add(lines);
        return group;
    }

    private gripper(pose: Pose): Group {
        const group = this.triad(pose, 1);
        const ring: number[] = [];
        const radius = this.scale * 0.022;
        for (let i = 0; i < 24; i++) ring.push(0, radius * Math.cos((i * Math.PI) / 12), radius * Math.sin((i * Math.PI) / 12));
        const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(ring, 3));
        group.add(new LineLoop(geometry, new LineBasicMaterial({ color: GRIPPER, depthTest: false, transparent: true })));
        return group;
    }

    /** The arrow ends at the handle and points the way the hand comes. */
    private handle(pose: Pose, approach: Vec3 | null): Group {
        const group = this.triad(pose, 0.8);
        if (!approach) return group;
        const direction = new Vector3(...approach).normalize();
        const reach = this.scale * 0.11;
        const arrow = new ArrowHelper(direction, direction.clone().multiplyScalar(-reach), reach, HANDLE, reach * 0.3, reach * 0.17);
        for (const part of [arrow.line, arrow.cone]) {
            const material = part.material as LineBasicMaterial;
            Object.assign(material, { depthTest: false, transparent: true });
        }
        group.add(arrow);
        return group;
    }
}

function placed(pose: Pose): Group {
    const group = new Group();
    group.matrixAutoUpdate = false;
    group.matrix.copy(matrixOf(pose));
    return group;
}

function centreOf(polygon: Vec3[]): number[] {
    return [0, 1, 2].map((axis) => polygon.reduce((sum, point) => sum + point[axis]!, 0) / Math.max(polygon.length, 1));
}

/** A polygon in the frame of its link: outline, and a translucent area. */
function surface(polygon: Vec3[], colour: string): Group {
    const group = new Group();
    if (polygon.length < 3) return group;
    const corners = polygon.map((point) => new Vector3(...point));
    const normal = new Vector3();
    corners.forEach((a, i) => normal.add(new Vector3().crossVectors(a, corners[(i + 1) % corners.length]!)));
    normal.normalize();
    const u = corners[1]!.clone().sub(corners[0]!).normalize();
    const v = new Vector3().crossVectors(normal, u);
    const flat = corners.map((p) => new Vector2(p.dot(u), p.dot(v)));
    const geometry = new BufferGeometry().setFromPoints(corners);
    const outline = new Line(new BufferGeometry().setFromPoints([...corners, corners[0]!]), new LineBasicMaterial({ color: colour }));
    geometry.setIndex(ShapeUtils.triangulateShape(flat, []).flat());
    const material = new MeshBasicMaterial({
        color: colour,
        transparent: true,
        opacity: 0.32,
        side: DoubleSide,
        forceSinglePass: true,
        depthWrite: false,
        polygonOffset: true,
        polygonOffsetFactor: -2,
        polygonOffsetUnits: -2,
    });
    group.add(new Mesh(geometry, material), outline);
    return group;
}
