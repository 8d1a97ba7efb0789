/** `window.foliate`: what tests and other programs ask of the page. */
import { linkName } from "../data/names";
import { poseOf } from "../motion/kinematics";
import type { Page } from "../panes/layout";
import type { Model, SwitchName } from "./model";
import { chooseTheme, type Theme } from "./theme";

const errors: string[] = [];

/** Errors that a person who looks at the page would not see. */
export function keepErrors(): void {
    addEventListener("error", (event) => errors.push(String(event.message)));
    addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
}

export function hooks(model: Model, page: Page, begun: number): object {
    const { view } = model;
    const { stage } = page.scene;
    const ready = performance.now();
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
        /** Draws at once. */
        frame: () => stage.draw(),
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
            readyMs: Math.round(ready - begun),
            sinceNavigationMs: Math.round(ready),
            frames: stage.frames,
            lastFrameMs: stage.lastFrameMs,
            drawCalls: stage.renderer.info.render.calls,
            triangles: stage.renderer.info.render.triangles,
            links: view.links.length,
        }),
    };
}
