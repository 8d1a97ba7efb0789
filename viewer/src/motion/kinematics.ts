/** Forward kinematics: from a configuration to the pose of each joint's body and each link in the world. */
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Joint, Pose, ViewDocument } from "../data/document";

const ONE = new Vector3(1, 1, 1);

export function matrixOf(pose: Pose): Matrix4 {
    const [x, y, z, qx, qy, qz, qw] = pose;
    return new Matrix4().compose(new Vector3(x, y, z), new Quaternion(qx, qy, qz, qw).normalize(), ONE);
}

export function poseOf(matrix: Matrix4): Pose {
    const [p, q, s] = [new Vector3(), new Quaternion(), new Vector3()];
    matrix.decompose(p, q, s);
    return [p.x, p.y, p.z, q.x, q.y, q.z, q.w];
}

export function sizeOf(joint: Joint): number {
    return joint.type === "freeflyer" ? 7 : joint.type === "planar" ? 3 : 1;
}

export function velocitySizeOf(joint: Joint): number {
    return joint.type === "freeflyer" ? 6 : sizeOf(joint);
}

export class Kinematics {
    readonly worldFromJoint: Matrix4[];
    readonly worldFromLink: Matrix4[];
    private readonly parentFromJoint: Matrix4[];
    private readonly jointFromLink: Matrix4[];
    private readonly axes: Vector3[];
    private readonly motion = new Matrix4();
    private readonly rotation = new Quaternion();
    private readonly place = new Vector3();

    constructor(private readonly view: ViewDocument) {
        this.parentFromJoint = view.joints.map((joint) => matrixOf(joint.parent_from_joint));
        this.jointFromLink = view.links.map((link) => matrixOf(link.joint_from_link));
        this.axes = view.joints.map((joint) => new Vector3(...(joint.axis ?? [0, 0, 1])).normalize());
        this.worldFromJoint = view.joints.map(() => new Matrix4());
        this.worldFromLink = this.jointFromLink.map((matrix) => matrix.clone());
    }

    /** Poses of all joints and links; allocates nothing. */
    update(configuration: ArrayLike<number>): void {
        for (let j = 0; j < this.view.joints.length; j++) this.updateJoint(j, configuration);
        for (let l = 0; l < this.view.links.length; l++) this.updateLink(l);
    }

    /** Poses of the joints that carry one link, and of the link. */
    updateChain(link: number, configuration: ArrayLike<number>): Matrix4 {
        for (const j of this.chainOf(link)) this.updateJoint(j, configuration);
        return this.updateLink(link);
    }

    /** The joints that carry a link, the outermost parent first. */
    chainOf(link: number): number[] {
        const chain: number[] = [];
        for (let j = this.view.links[link]?.joint ?? null; j !== null; j = this.view.joints[j]?.parent ?? null) chain.unshift(j);
        return chain;
    }

    private updateLink(l: number): Matrix4 {
        const world = this.worldFromLink[l]!;
        const joint = this.view.links[l]!.joint;
        if (joint === null) return world.copy(this.jointFromLink[l]!);
        return world.multiplyMatrices(this.worldFromJoint[joint]!, this.jointFromLink[l]!);
    }

    private updateJoint(j: number, configuration: ArrayLike<number>): void {
        const joint = this.view.joints[j]!;
        const world = this.worldFromJoint[j]!;
        if (joint.parent === null) world.copy(this.parentFromJoint[j]!);
        else world.multiplyMatrices(this.worldFromJoint[joint.parent]!, this.parentFromJoint[j]!);
        const at = joint.q ?? -1;
        const number = (i: number): number => configuration[at + i] ?? 0;
        switch (joint.type) {
            case "revolute":
                this.motion.makeRotationAxis(this.axes[j]!, this.value(joint, configuration));
                break;
            case "prismatic": {
                const axis = this.axes[j]!;
                const value = this.value(joint, configuration);
                this.motion.makeTranslation(axis.x * value, axis.y * value, axis.z * value);
                break;
            }
            case "planar":
                this.motion.makeRotationZ(number(2)).setPosition(number(0), number(1), 0);
                break;
            case "freeflyer":
                this.rotation.set(number(3), number(4), number(5), number(6)).normalize();
                this.place.set(number(0), number(1), number(2));
                this.motion.compose(this.place, this.rotation, ONE);
        }
        world.multiply(this.motion);
    }

    /** The value of a joint of one number, or of the one that it follows. */
    private value(joint: Joint, configuration: ArrayLike<number>): number {
        if (joint.leader === null || joint.leader === undefined) return configuration[joint.q ?? -1] ?? 0;
        const leader = this.view.joints[joint.leader];
        return (joint.multiplier ?? 1) * (configuration[leader?.q ?? -1] ?? 0) + (joint.offset ?? 0);
    }
}

/** Zeros with unit quaternions, moved into the limits. */
export function neutral(view: ViewDocument): Float64Array {
    const q = new Float64Array(view.coordinates.length);
    for (const joint of view.joints) {
        if (joint.q === null || joint.q === undefined) continue;
        for (let i = 0; i < sizeOf(joint); i++) {
            const value = joint.type === "freeflyer" && i === 6 ? 1 : 0;
            const low = joint.lower?.[i] ?? -Infinity;
            const high = joint.upper?.[i] ?? Infinity;
            const isQuaternion = joint.type === "freeflyer" && i > 2;
            q[joint.q + i] = isQuaternion ? value : Math.min(Math.max(value, low), high);
        }
    }
    return q;
}
