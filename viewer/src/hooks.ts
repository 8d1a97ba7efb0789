/** `window.foliate`: what tests and other programs ask of the page. */
import { Vector3 } from "three";
import { linkName } from "./data/names";
import { poseOf } from "./motion/kinematics";
import type { Page } from "./panes/layout";
import type { Model, SwitchName } from "./app/model";
import { chooseTheme, type Theme } from "./app/theme";

const errors: string[] = [];

/** Errors that a person who looks at the page would not see. */
export function keepErrors(): void {
    addEventListener("error", (event) => errors.push(String(event.message)));
    addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
}

/** Milliseconds since the beginning of the navigation. */
export interface Times {
    begun: number;
    read: number;
    built: number;
    drawn: number;
}

export function hooks(model: Model, page: Page, times: Times): object {
    const { view } = model;
    const { stage } = page.scene;
    const idOf = (list: { id: number | string }[] | undefined, index: number | null | undefined): number | string | null => list?.[index ?? -1]?.id ?? null;
    const segment = () => model.path?.segment(model.segment.value);
    return {
        setTime: (t: number) => model.setTime(t),
        time: () => model.time.value,
        duration: () => model.duration,
        play: () => model.play(true),
        pause: () => model.playing.set(false),
        playing: () => model.playing.value,
        setConfiguration: (q: number[]) => model.pose(q, "A configuration of the host"),
        configuration: () => [...model.configuration.value],
        linkPose: (name: string) => {
            const link = view.links.findIndex((one) => one.name === name);
            return link < 0 ? null : poseOf(model.kinematics.worldFromLink[link]!);
        },
        activeState: () => idOf(view.graph?.states, segment()?.state),
        activeTransition: () => idOf(view.graph?.transitions, segment()?.transition),
        clickState: (id: number | string) => {
            const element = document.querySelector(`[data-state="${CSS.escape(String(id))}"]`);
            element?.dispatchEvent(new MouseEvent("click", { bubbles: true }));
            return !!element;
        },
        collisionsNow: () => page.contacts.now().map(([a, b]) => [linkName(view, a), linkName(view, b)]),
        hiddenErrors: () => [...errors],
        missing: () => view.links.flatMap((link) => link.visual.flatMap((v) => (v.missing ? [v.missing] : []))),
        setTheme: (value: Theme) => chooseTheme(value),
        toggle: (name: SwitchName, on?: boolean) => model.toggle(name, on),
        selectPane: (name: string) => page.tabs.select(name),
        look: (name: string) => page.scene.views.look(name as never, false),
        /** Where a point of the world is on the page, in pixels. */
        project: (point: [number, number, number]) => {
            const box = stage.renderer.domElement.getBoundingClientRect();
            stage.camera.updateMatrixWorld();
            const { x, y } = new Vector3(...point).project(stage.camera);
            return [box.left + ((x + 1) / 2) * box.width, box.top + ((1 - y) / 2) * box.height];
        },
        /** Draws at once. */
        frame: () => stage.drawWhole(),
        shadows: (on: boolean) => stage.setShadows(on),
        /** The picture as bytes of RGBA, drawn now. */
        pixels: () => {
            stage.draw();
            const gl = stage.renderer.getContext();
            const { drawingBufferWidth: w, drawingBufferHeight: h } = gl;
            const out = new Uint8Array(w * h * 4);
            gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, out);
            return out;
        },
        stats: () => ({
            readyMs: Math.round(times.drawn),
            readMs: Math.round(times.read - times.begun),
            buildMs: Math.round(times.built - times.read),
            drawMs: Math.round(times.drawn - times.built),
            frames: stage.frames,
            lastFrameMs: stage.lastFrameMs,
            drawCalls: stage.renderer.info.render.calls,
            triangles: stage.renderer.info.render.triangles,
            links: view.links.length,
        }),
    };
}
