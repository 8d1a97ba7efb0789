/** The search: outcome, the roadmap as points, its growth step by step, the funnel. */
import { groupColour } from "../app/colours";
import { h, icon, iconButton } from "../app/dom";
import type { Model } from "../app/model";
import { theme } from "../app/theme";
import type { SearchData } from "../data/document";
import { count, linkName } from "../data/names";
import type { Colouring, Roadmap } from "../motion/roadmap";
import type { View3d } from "../scene/view3d";
import { funnel } from "./funnel";

/** Seconds that the replay of a whole growth takes. */
const REPLAY = 8;

export function searchPane(model: Model, scene: View3d, data: SearchData): HTMLElement {
    const words = (data.words ?? []).map((line) => h("p", {}, line));
    const outcome = data.outcome ? h("p", { class: "outcome" }, `Outcome: ${data.outcome}`) : null;
    const rows = data.funnel ?? [];
    return h(
        "div",
        { class: "search-pane" },
        outcome,
        ...words,
        scene.roadmap ? roadmapPart(model, scene, scene.roadmap) : null,
        rows.length > 0 ? h("h3", {}, "What became of each transition") : null,
        rows.length > 0 ? funnel(model, rows) : null,
    );
}

/** Links whose place tells nodes apart: those of grippers, and of objects that move. */
function choices(model: Model): [string, number][] {
    const { view } = model;
    const hands = (view.documents?.grippers ?? []).map((g): [string, number] => [g.name, g.link]);
    const objects = view.links.flatMap((link, l): [string, number][] => {
        const root = link.joint !== null ? view.joints[link.joint] : undefined;
        return root?.type === "freeflyer" && view.parts[link.part]!.kind === "object" ? [[link.name, l]] : [];
    });
    const found = [...hands, ...objects];
    const moving = view.links.findLastIndex((link) => link.joint !== null);
    return found.length > 0 ? found : [[linkName(view, moving), moving]];
}

function roadmapPart(model: Model, scene: View3d, roadmap: Roadmap): HTMLElement {
    const cloud = scene.cloud!;
    const places = choices(model);
    const place = h("select", {}, ...places.map(([name], i) => h("option", { value: i }, name)));
    const by = h("select", {}, ...(["tree", "state", "component"] as const).map((name) => h("option", { value: name }, name)));
    const step = h("input", { type: "range", min: 0, max: roadmap.lastStep, value: roadmap.lastStep, "aria-label": "Step of the search" });
    const told = h("output", {});
    const key = h("div", { class: "groups" });
    const reveal = (): void => {
        const { nodes, edges } = cloud.reveal(Number(step.value));
        told.textContent = `step ${count(Number(step.value))}: ${count(nodes)} nodes, ${count(edges)} edges`;
        scene.stage.invalidate();
    };
    let arranged = false;
    const arrange = (): void => {
        // Kinematics of all nodes: only when someone looks.
        if (!model.switches.roadmap.value) return;
        arranged = true;
        const colouring = by.value as Colouring;
        cloud.arrange(places[Number(place.value)]![1], colouring);
        const groups = roadmap.groups(colouring);
        key.replaceChildren(
            ...groups.slice(0, 10).map(([group, n], i) => {
                const chip = h("span", { class: "chip" });
                chip.style.background = groupColour(colouring === "component" ? i : group, theme.value);
                return h("span", { class: "group" }, chip, `${roadmap.groupName(group, colouring)} (${count(n)})`);
            }),
            ...(groups.length > 10 ? [h("span", { class: "group" }, `and ${groups.length - 10} more`)] : []),
        );
        reveal();
    };
    place.addEventListener("change", arrange);
    by.addEventListener("change", arrange);
    step.addEventListener("input", reveal);
    model.switches.roadmap.watch((on) => on && !arranged && arrange());
    theme.watch(arrange);
    reveal();
    const shown = h("input", { type: "checkbox", onchange: () => model.toggle("roadmap", shown.checked) });
    model.switches.roadmap.watch((on) => (shown.checked = on));
    return h(
        "div",
        { class: "roadmap" },
        h("h3", {}, "Roadmap"),
        h("label", { class: "check" }, shown, "Show it in the scene; click a point to see its configuration"),
        h("div", { class: "fields" }, h("label", {}, "Points at", place), h("label", {}, "Colour by", by)),
        h("div", { class: "growth" }, replayButton(model, step, reveal), step),
        told,
        key,
    );
}

/** Plays the growth: one callback a frame while it runs. */
function replayButton(model: Model, step: HTMLInputElement, reveal: () => void): HTMLButtonElement {
    let running = 0;
    const last = Number(step.max);
    const draw = (): void => {
        const label = running ? "Pause the growth" : "Replay the growth";
        button.replaceChildren(icon(running ? "pause" : "play"));
        button.setAttribute("aria-label", label);
        button.title = label;
    };
    const stop = (): void => {
        cancelAnimationFrame(running);
        running = 0;
        draw();
    };
    const start = (): void => {
        model.toggle("roadmap", true);
        const from = Number(step.value) >= last ? 0 : Number(step.value);
        const begin = performance.now();
        const frame = (now: number): void => {
            const at = Math.min(from + ((now - begin) / 1000 / REPLAY) * last, last);
            step.value = String(Math.round(at));
            reveal();
            if (at < last) running = requestAnimationFrame(frame);
            else stop();
        };
        running = requestAnimationFrame(frame);
        draw();
    };
    const button = iconButton("play", "Replay the growth", () => (running ? stop() : start()));
    step.addEventListener("pointerdown", () => running && stop());
    return button;
}
