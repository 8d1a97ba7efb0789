/** A path as samples: the configuration, segment, clearance at any time. */
import { Quaternion } from "three";
import type { Joint, LinkPair, PathData, Segment, ViewDocument } from "../data/document";
import type { Arrays } from "../data/read";
import { velocitySizeOf } from "./kinematics";

/** The last index whose value is at most `t`; 0 where there is none. */
export function indexAt(times: ArrayLike<number>, t: number): number {
    let low = 0;
    let high = times.length;
    while (low + 1 < high) {
        const middle = (low + high) >> 1;
        if (times[middle]! <= t) low = middle;
        else high = middle;
    }
    return low;
}

/** The index whose value is nearest to `t`. */
export function nearest(times: ArrayLike<number>, t: number): number {
    const k = indexAt(times, t);
    return k + 1 < times.length && times[k + 1]! - t < t - times[k]! ? k + 1 : k;
}

export interface Clearance {
    times: Float32Array;
    values: Float32Array;
    pairs: LinkPair[];
    pair: Uint16Array;
    /** Six numbers a sample: the two closest points in the world. */
    points: Float32Array;
}

export class Path {
    readonly times: Float32Array;
    readonly configurations: Float32Array;
    readonly velocities: Float32Array | null;
    readonly velocitySize: number;
    readonly clearance: Clearance | null;
    readonly duration: number;
    private readonly starts: number[];
    private readonly width: number;
    /** Joints whose rotation is not interpolated number by number. */
    private readonly flyers: Joint[];

    constructor(
        view: ViewDocument,
        readonly data: PathData,
        arrays: Arrays,
    ) {
        this.width = view.coordinates.length;
        this.times = arrays.float32(data.times, data.samples);
        this.configurations = arrays.float32(data.configurations, data.samples * this.width);
        const own = view.joints.filter((joint) => joint.q !== null && joint.q !== undefined);
        this.velocitySize = own.reduce((sum, joint) => sum + velocitySizeOf(joint), 0);
        const at = data.velocities ?? null;
        this.velocities = at === null ? null : arrays.float32(at, data.samples * this.velocitySize);
        this.flyers = own.filter((joint) => joint.type === "freeflyer");
        this.starts = data.segments.map((segment) => segment.from);
        this.duration = data.duration;
        const c = data.clearance;
        this.clearance = c
            ? {
                  times: arrays.float32(c.times, c.samples),
                  values: arrays.float32(c.values, c.samples),
                  pairs: c.pairs,
                  pair: arrays.uint16(c.pair, c.samples),
                  points: arrays.float32(c.points, c.samples * 6),
              }
            : null;
    }

    /** Writes the configuration at a time: numbers go straight, the rotations of free-flyers turn at even speed. */
    configurationAt(t: number, out: Float64Array): void {
        const n = this.width;
        const k = Math.min(indexAt(this.times, t), Math.max(this.times.length - 2, 0));
        const next = Math.min(k + 1, this.times.length - 1);
        const span = this.times[next]! - this.times[k]!;
        const s = span > 0 ? Math.min(Math.max((t - this.times[k]!) / span, 0), 1) : 0;
        const a = k * n;
        const b = next * n;
        const q = this.configurations;
        for (let i = 0; i < n; i++) out[i] = q[a + i]! + s * (q[b + i]! - q[a + i]!);
        for (const joint of this.flyers) {
            const i = joint.q!;
            Quaternion.slerpFlat(out as unknown as number[], i + 3, q as unknown as number[], a + i + 3, q as unknown as number[], b + i + 3, s);
        }
    }

    segmentAt(t: number): number {
        return indexAt(this.starts, t);
    }

    segment(index: number): Segment | undefined {
        return this.data.segments[index];
    }
}
