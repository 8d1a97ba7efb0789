/** What the page shows at a moment. Panes and the scene watch it; only its methods change it. */
import type { Vec3, ViewDocument, Where } from "../data/document";
import type { Arrays } from "../data/read";
import { Kinematics, neutral } from "../motion/kinematics";
import { Path } from "../motion/path";
import { Signal } from "./signal";

/** Links drawn in red, and a line or point between them. */
export interface Mark {
    links: number[];
    points: Vec3[];
    /** The number that stands at the points: a depth, an error. */
    number: string;
    words: string;
}

/** What can be switched on and off in the scene. */
export const SWITCHES = {
    visual: "Visual geometry",
    collision: "Collision geometry",
    start: "Ghost of the start",
    goal: "Ghost of the goal",
    clearance: "Closest pair",
    grippers: "Grippers",
    handles: "Handles",
    surfaces: "Contact surfaces",
    frames: "Frames",
    names: "Names of features",
    roadmap: "Roadmap of the search",
    ground: "Ground grid",
} as const;
export type SwitchName = keyof typeof SWITCHES;

export class Model {
    readonly kinematics: Kinematics;
    readonly path: Path | null;
    /** The configuration that is shown; its content changes in place. */
    readonly configuration: Signal<Float64Array>;
    /** Why a configuration is shown that is not on the path; empty while the path is shown. */
    readonly posed = new Signal("");
    readonly time = new Signal(0);
    readonly playing = new Signal(false);
    readonly speed = new Signal(1);
    /** Index of the segment at the time, -1 without a path. */
    readonly segment = new Signal(-1);
    readonly mark = new Signal<Mark | null>(null);
    readonly measuring = new Signal(false);
    readonly switches: Record<SwitchName, Signal<boolean>>;
    private lastFrame = 0;

    constructor(
        readonly view: ViewDocument,
        readonly arrays: Arrays,
    ) {
        this.kinematics = new Kinematics(view);
        this.path = view.path && view.path.samples > 0 ? new Path(view, view.path, arrays) : null;
        const first = view.start ?? neutral(view);
        this.configuration = new Signal<Float64Array>(Float64Array.from(first));
        const isScene = view.kind === "scene";
        const on: SwitchName[] = ["visual", "ground", ...(this.path ? [] : (["grippers", "handles"] as const))];
        if (isScene) on.push("goal", "surfaces");
        if (view.kind === "search") on.push("roadmap");
        const names = Object.keys(SWITCHES) as SwitchName[];
        this.switches = Object.fromEntries(names.map((name) => [name, new Signal(on.includes(name))])) as Record<SwitchName, Signal<boolean>>;
        if (this.path) this.setTime(0);
        else this.kinematics.update(this.configuration.value);
    }

    get duration(): number {
        return this.path?.duration ?? 0;
    }

    /** Shows the path at a time. */
    setTime(time: number): void {
        if (!this.path) return;
        const t = Math.min(Math.max(time, 0), this.duration);
        this.path.configurationAt(t, this.configuration.value);
        this.posed.set("");
        this.time.set(t);
        this.segment.set(this.path.segmentAt(t));
        this.showConfiguration();
    }

    /** Shows a configuration that is not on the path. */
    pose(configuration: ArrayLike<number>, words: string): void {
        this.playing.set(false);
        this.configuration.value.set(configuration);
        this.posed.set(words);
        this.showConfiguration();
    }

    /** Shows what a finding is about: its configuration, the links in red. */
    show(where: Where | null | undefined, mark: Mark): void {
        const found = where === "start" ? this.view.start : where === "goal" ? this.view.goal : where;
        if (found) this.pose(found, mark.words);
        this.mark.set(mark);
    }

    /** Back to the path, nothing marked. */
    clear(): void {
        this.mark.set(null);
        this.measuring.set(false);
        if (this.path) this.setTime(this.time.value);
        else if (this.posed.value) {
            this.pose(this.view.start ?? neutral(this.view), "");
        }
    }

    toggle(name: SwitchName, on?: boolean): void {
        const at = this.switches[name];
        at.set(on ?? !at.value);
    }

    play(on = !this.playing.value): void {
        if (!this.path) return;
        this.mark.set(null);
        if (on && (this.time.value >= this.duration || this.posed.value)) {
            this.setTime(this.time.value >= this.duration ? 0 : this.time.value);
        }
        this.playing.set(on);
        this.lastFrame = 0;
    }

    /** One frame of playing. `now` in milliseconds. */
    advance(now: number): void {
        const step = this.lastFrame ? Math.min(now - this.lastFrame, 250) / 1000 : 0;
        this.lastFrame = now;
        const t = this.time.value + step * this.speed.value;
        this.setTime(t);
        if (t >= this.duration) this.playing.set(false);
    }

    /** To the start of the next segment, or of this one or the one before. */
    step(by: 1 | -1): void {
        const segments = this.path?.data.segments ?? [];
        const here = segments[this.segment.value];
        if (!here) return;
        this.playing.set(false);
        if (by > 0) this.setTime(segments[this.segment.value + 1]?.from ?? this.duration);
        else if (this.time.value - here.from > 1e-3) this.setTime(here.from);
        else this.setTime(segments[this.segment.value - 1]?.from ?? 0);
    }

    /** To the next segment that is in a state, after the last to the first; false where the path is never in it. */
    visit(state: number): boolean {
        const segments = this.path?.data.segments ?? [];
        const after = segments.find((s) => s.state === state && s.from > this.time.value + 1e-6);
        const found = after ?? segments.find((s) => s.state === state);
        if (!found) return false;
        this.mark.set(null);
        this.setTime(found.from);
        return true;
    }

    private showConfiguration(): void {
        this.kinematics.update(this.configuration.value);
        this.configuration.tell();
    }
}
