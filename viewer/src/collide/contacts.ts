/** Which of the tested pairs of links touch in the configuration that is shown. Cylinders, spheres and capsules are many-sided here. */
import { Matrix4, Vector3, type BufferGeometry } from "three";
import type { LinkPair, ViewDocument } from "../data/document";
import { matrixOf, type Kinematics } from "../motion/kinematics";
import type { Geometries } from "../shape/geometries";
import { TriangleTree, treesTouch } from "./triangle_tree";

interface Part {
    tree: TriangleTree;
    linkFromShape: Matrix4;
    worldFromShape: Matrix4;
    centre: Vector3;
    worldCentre: Vector3;
    radius: number;
}

export class Contacts {
    private readonly trees = new Map<BufferGeometry, TriangleTree>();
    private parts: Part[][] | null = null;

    constructor(
        private readonly view: ViewDocument,
        private readonly kinematics: Kinematics,
        private readonly geometries: Geometries,
    ) {}

    get pairs(): LinkPair[] {
        return this.view.pairs ?? [];
    }

    /** Trees are built at the first question. */
    now(): LinkPair[] {
        if (this.pairs.length === 0) return [];
        this.parts ??= this.view.links.map((_, l) => this.partsOf(l));
        this.parts.forEach((parts, l) => {
            for (const part of parts) {
                part.worldFromShape.multiplyMatrices(this.kinematics.worldFromLink[l]!, part.linkFromShape);
                part.worldCentre.copy(part.centre).applyMatrix4(part.worldFromShape);
            }
        });
        return this.pairs.filter(([a, b]) => this.parts![a]!.some((p) => this.parts![b]!.some((q) => touch(p, q))));
    }

    private partsOf(link: number): Part[] {
        // A box in the place of a missing mesh says nothing about contacts.
        const known = this.view.links[link]!.collision.filter((c) => !c.missing);
        return known.map(({ shape, pose }) => {
            const geometry = this.geometries.of(shape);
            let tree = this.trees.get(geometry);
            if (!tree) this.trees.set(geometry, (tree = new TriangleTree(geometry)));
            if (!geometry.boundingSphere) geometry.computeBoundingSphere();
            const { center, radius } = geometry.boundingSphere!;
            return {
                tree,
                linkFromShape: matrixOf(pose),
                worldFromShape: new Matrix4(),
                centre: center.clone(),
                worldCentre: new Vector3(),
                radius,
            };
        });
    }
}

function touch(a: Part, b: Part): boolean {
    const reach = a.radius + b.radius;
    if (a.worldCentre.distanceToSquared(b.worldCentre) > reach * reach) return false;
    return treesTouch(a.tree, a.worldFromShape, b.tree, b.worldFromShape);
}
