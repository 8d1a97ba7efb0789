/** The links of the scene: visual and collision geometry that follow the kinematics, and links that are marked. */
import { Color, Group, LineSegments, Mesh, type Material, type Object3D } from "three";
import { partColour } from "../app/colours";
import type { Model } from "../app/model";
import type { Link, Shape, Pose } from "../data/document";
import { matrixOf } from "../motion/kinematics";
import type { Geometries } from "./geometries";
import type { Materials } from "./materials";

/** A shape as it is drawn. */
export interface Drawn {
    shape: Shape;
    pose: Pose;
    material: Material;
}

export class Bodies {
    readonly root = new Group();
    readonly links: Group[];
    private readonly visuals: Mesh[][] = [];
    private readonly collisions: Object3D[][] = [];
    private collisionMade = false;
    private marked: Mesh[] = [];
    private marks: Mesh[] = [];

    constructor(
        private readonly model: Model,
        private readonly geometries: Geometries,
        private readonly materials: Materials,
    ) {
        const { view } = model;
        this.links = view.links.map((link, index) => {
            const group = new Group();
            group.name = link.name;
            group.userData["link"] = index;
            group.matrixAutoUpdate = false;
            this.visuals.push(this.drawn(index).map((drawn) => this.mesh(drawn, group)));
            this.root.add(group);
            return group;
        });
        model.configuration.watch(() => this.follow());
        model.switches.visual.watch((on) => this.visuals.flat().forEach((mesh) => (mesh.visible = on)));
        model.switches.collision.watch((on) => {
            if (on) this.makeCollisions();
            this.collisions.flat().forEach((object) => (object.visible = on));
            this.materials.fade(on);
        });
        model.mark.watch((mark) => this.markLinks(mark?.links ?? []));
    }

    /** What is drawn of a link: its visuals; its collision shapes where its part has no visuals or a file is missing. */
    drawn(index: number): Drawn[] {
        const { view } = this.model;
        const link = view.links[index]!;
        const material = this.materials.solid(this.colourOf(link), 1);
        const byCollision = (by: Material): Drawn[] => link.collision.map((c) => ({ ...c, material: by }));
        if (!view.links.some((other) => other.part === link.part && other.visual.length > 0)) return byCollision(material);
        const present = link.visual.filter((v) => !v.missing);
        const drawn = present.map((v) => {
            const colour = v.color ? new Color().setRGB(v.color[0], v.color[1], v.color[2], "srgb") : this.colourOf(link);
            return { shape: v.shape, pose: v.pose, material: this.materials.solid(colour, v.color?.[3] ?? 1) };
        });
        if (present.length === link.visual.length) return drawn;
        if (link.collision.length > 0) return [...drawn, ...byCollision(this.materials.missing)];
        const placeholder: Shape = { box: [0.04, 0.04, 0.04] };
        const absent = link.visual.filter((v) => v.missing);
        return [...drawn, ...absent.map((v) => ({ shape: placeholder, pose: v.pose, material: this.materials.missing }))];
    }

    /** The link that an object of the scene belongs to. */
    linkOf(object: Object3D | null): number | null {
        for (let at = object; at; at = at.parent) {
            const link: unknown = at.userData["link"];
            if (typeof link === "number") return link;
        }
        return null;
    }

    /** What a ray can hit: the geometry that is shown. */
    shown(): Object3D[] {
        return [...this.visuals.flat(), ...this.collisions.flat()].filter((object) => object.visible && object instanceof Mesh);
    }

    private follow(): void {
        const poses = this.model.kinematics.worldFromLink;
        this.links.forEach((group, l) => {
            group.matrix.copy(poses[l]!);
            group.matrixWorldNeedsUpdate = true;
        });
    }

    private colourOf(link: Link): Color {
        const { parts } = this.model.view;
        const { kind } = parts[link.part]!;
        const index = parts.slice(0, link.part).filter((part) => part.kind === kind).length;
        return new Color(partColour(kind, index));
    }

    private mesh(drawn: Drawn, group: Group): Mesh {
        const mesh = new Mesh(this.geometries.of(drawn.shape), drawn.material);
        mesh.matrixAutoUpdate = false;
        mesh.matrix.copy(matrixOf(drawn.pose));
        mesh.castShadow = true;
        mesh.receiveShadow = true;
        group.add(mesh);
        return mesh;
    }

    /** Collision geometry is made when it is first shown. */
    private makeCollisions(): void {
        if (this.collisionMade) return;
        this.collisionMade = true;
        this.model.view.links.forEach((link, l) => {
            this.collisions[l] = link.collision.flatMap((c) => {
                const mesh = this.mesh({ ...c, material: this.materials.collision }, this.links[l]!);
                mesh.castShadow = mesh.receiveShadow = false;
                const edges = new LineSegments(this.geometries.edgesOf(mesh.geometry), this.materials.collisionEdges);
                edges.matrixAutoUpdate = false;
                edges.matrix.copy(mesh.matrix);
                this.links[l]!.add(edges);
                return [mesh, edges];
            });
        });
    }

    /** Marked links are red, and shine through what hides them. */
    private markLinks(links: number[]): void {
        for (const mesh of this.marked) mesh.material = mesh.userData["material"] as Material;
        for (const mark of this.marks) mark.removeFromParent();
        const meshes = links.flatMap((link) => this.visuals[link] ?? []);
        for (const mesh of meshes) {
            mesh.userData["material"] = mesh.material;
            mesh.material = this.materials.highlight;
        }
        this.marks = links.flatMap((link) => {
            // A link may be drawn by nothing but its collision shapes.
            const shapes = this.model.view.links[link]?.collision ?? [];
            return shapes.map((c) => {
                const mesh = this.mesh({ ...c, material: this.materials.highlightThrough }, this.links[link]!);
                mesh.castShadow = false;
                mesh.renderOrder = 10;
                return mesh;
            });
        });
        this.marked = meshes;
    }
}
