/** The constraint graph, laid out by the program: what is active is lit, a click on a state goes to its next visit. */
import { rateColour } from "../app/colours";
import { h, svg } from "../app/dom";
import type { Model } from "../app/model";
import { theme } from "../app/theme";
import type { Graph, GraphState, GraphTransition } from "../data/document";
import { count } from "../data/names";
import { panZoom } from "./pan_zoom";

/** Units of the drawing a pixel above which texts are too small to read. */
const UNREADABLE = 2.6;
/** Lines above which only those of the state that is looked at are drawn strongly. */
const CROWDED = 60;

export function graphPane(model: Model, graph: Graph): HTMLElement {
    const most = graph.transitions.reduce((found, t) => Math.max(found, t.tried ?? 0), 1);
    const edges = graph.transitions.map((transition) => edge(transition, most));
    const states = graph.states.map((state) => box(state));
    const drawing = svg("svg", { class: "graph", role: "group", "aria-label": "Constraint graph" }, markers(), ...edges.map((e) => e.root), ...marksOf(graph), ...states);
    const focus = (): [number, number] => {
        const state = graph.states[model.path?.segment(model.segment.value)?.state ?? 0]!;
        return [state.x + state.w / 2, state.y + state.h / 2];
    };
    const view = panZoom(drawing, graph.width, graph.height, (scale) => drawing.classList.toggle("small", scale > UNREADABLE), focus);
    states.forEach((element, s) => {
        const visited = model.path?.data.segments.some((segment) => segment.state === s) ?? false;
        element.classList.toggle("visited", visited);
        const go = (): void => void model.visit(s);
        element.addEventListener("click", go);
        element.addEventListener("keydown", (event) => {
            if (event.key !== "Enter" && event.key !== " ") return;
            event.preventDefault();
            event.stopPropagation();
            go();
        });
    });
    drawing.classList.toggle("crowded", edges.length > CROWDED);
    const near = showNear(drawing, graph, edges);
    model.segment.watch((at) => {
        const segment = model.path?.segment(at);
        near(segment?.state ?? (model.path ? null : 0));
        states.forEach((element, s) => element.classList.toggle("active", s === segment?.state));
        edges.forEach(({ root }, e) => root.classList.toggle("active", e === segment?.transition));
        const state = graph.states[segment?.state ?? -1];
        if (state) view.reveal(state.x, state.y, state.w, state.h);
    });
    theme.watch((value) => edges.forEach((e) => e.paint((rate) => rateColour(rate, value))));
    const told = h("div", { class: "graph-told", role: "status" });
    const tried = graph.transitions.some((t) => (t.tried ?? 0) > 0);
    tellHover(drawing, graph, told, tried ? legend() : model.path ? "Click a state to go to its next visit." : "");
    const leftOut = graph.left_out ? h("p", { class: "graph-left-out" }, graph.left_out) : null;
    return h("div", { class: "graph-pane" }, drawing, view.buttons, leftOut, told);
}

function box(state: GraphState): SVGGElement {
    const lines = state.lines?.length ? state.lines : [state.name];
    const middle = state.y + state.h / 2 - ((lines.length - 1) * 15) / 2;
    return svg(
        "g",
        {
            class: `state${state.passed_through ? " passed-through" : ""}`,
            "data-state": state.id,
            tabindex: 0,
            role: "button",
            "aria-label": state.words || state.name,
        },
        svg("rect", { x: state.x, y: state.y, width: state.w, height: state.h, rx: state.passed_through ? state.h / 2 : 8 }),
        ...lines.map((line, i) => svg("text", { x: state.x + state.w / 2, y: middle + i * 15, "dominant-baseline": "central" }, line)),
    );
}

function marksOf(graph: Graph): SVGGElement[] {
    return (graph.marks ?? []).map(({ words, x, y, w, h: height }) =>
        svg(
            "g",
            { class: w > 0 ? "mark-box" : "mark-words" },
            w > 0 ? svg("rect", { x: x - w / 2, y: y - height / 2, width: w, height, rx: height / 2 }) : null,
            svg("text", { x, y, "dominant-baseline": "central" }, words),
        ),
    );
}

interface Edge {
    root: SVGGElement;
    paint(colourOf: (rate: number) => string): void;
}

/** `most` is how often the transition that was tried most was tried. */
function edge(transition: GraphTransition, most: number): Edge {
    const tried = transition.tried ?? 0;
    const width = tried > 0 ? 1.4 + (5 * Math.log1p(tried)) / Math.log1p(most) : 1.4;
    const d = route(transition);
    const line = svg("path", { class: "line", d, "stroke-width": width.toFixed(2), "marker-end": "url(#foliate-arrow)" });
    const root = svg(
        "g",
        { class: `transition ${transition.kind}`, "data-transition": transition.id },
        svg("path", { class: "hit", d }),
        svg("path", { class: "glow", d, "stroke-width": (width + 7).toFixed(2) }),
        line,
    );
    const paint = (colourOf: (rate: number) => string): void => {
        if (tried > 0) line.style.stroke = colourOf((transition.succeeded ?? 0) / tried);
    };
    return { root, paint };
}

/** Marks the lines of the state under the pointer or with the focus, else those of the active state, which is told to what is returned: without a path the first. */
function showNear(drawing: SVGSVGElement, graph: Graph, edges: Edge[]): (active: number | null) => void {
    let active: number | null = null;
    let looked: number | null = null;
    const update = (): void => {
        const state = looked ?? active;
        edges.forEach(({ root }, e) => {
            const { from, to } = graph.transitions[e]!;
            root.classList.toggle("near", from === state || to === state);
        });
    };
    const look = (event: Event): void => {
        const id = (event.target as Element).closest("[data-state]")?.getAttribute("data-state");
        const found = graph.states.findIndex((state) => String(state.id) === id);
        if (looked === (found < 0 ? null : found)) return;
        looked = found < 0 ? null : found;
        update();
    };
    for (const kind of ["pointerover", "focusin", "focusout"]) drawing.addEventListener(kind, look);
    drawing.addEventListener("pointerleave", () => {
        looked = null;
        update();
    });
    return (state) => {
        active = state;
        update();
    };
}

function route(transition: GraphTransition): string {
    const [first, ...rest] = transition.points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`);
    return first ? `M${first}L${rest.join("L")}` : "";
}

function markers(): SVGDefsElement {
    return svg(
        "defs",
        {},
        svg(
            "marker",
            { id: "foliate-arrow", viewBox: "0 0 10 10", refX: 8.5, refY: 5, markerWidth: 9, markerHeight: 9, markerUnits: "userSpaceOnUse", orient: "auto-start-reverse" },
            svg("path", { d: "M0 0.8L10 5L0 9.2z", fill: "context-stroke" }),
        ),
    );
}

/** What is under the pointer or has the focus, in words, below the drawing. */
function tellHover(drawing: SVGSVGElement, graph: Graph, told: HTMLElement, otherwise: HTMLElement | string): void {
    told.replaceChildren(otherwise);
    const tell = (event: Event): void => {
        const target = event.target as Element;
        const state = target.closest("[data-state]")?.getAttribute("data-state");
        const transition = target.closest("[data-transition]")?.getAttribute("data-transition");
        const s = graph.states.find((one) => String(one.id) === state);
        const t = graph.transitions.find((one) => String(one.id) === transition);
        told.textContent = s ? s.words || s.name : t ? transitionText(t) : "";
        if (!told.textContent) told.replaceChildren(otherwise);
    };
    drawing.addEventListener("pointerover", tell);
    drawing.addEventListener("focusin", tell);
    drawing.addEventListener("pointerleave", () => told.replaceChildren(otherwise));
}

function transitionText(t: GraphTransition): string {
    const parts = [t.words || t.name];
    if (t.waypoints?.length) parts.push(`by way of ${t.waypoints.join(", ")}`);
    if ((t.tried ?? 0) > 0) {
        const rate = (100 * (t.succeeded ?? 0)) / t.tried!;
        parts.push(`tried ${count(t.tried!)} times, ${rate < 10 ? rate.toFixed(1) : rate.toFixed(0)} % succeeded`);
    }
    return parts.join(" \u00b7 ");
}

function legend(): HTMLElement {
    return h("div", { class: "legend" }, h("span", {}, "never"), h("span", { class: "rate-bar" }), h("span", {}, "always succeeds; wider: tried more often"));
}
