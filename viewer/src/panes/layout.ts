/** The page: header, scene, timeline, graph and tabs beside it; on a phone all in one column, the graph as a tab. */
import { h, icon, iconButton } from "../app/dom";
import type { Model } from "../app/model";
import { chooseTheme, theme } from "../app/theme";
import { Contacts } from "../collide/contacts";
import { View3d } from "../scene/view3d";
import { stateWords } from "../data/names";
import { aboutPane } from "./about";
import { curvesPane } from "./curves";
import { graphPane } from "./graph";
import { helpDialog } from "./help";
import { jointsPane } from "./joints";
import { problemCount, problemsPane } from "./problems";
import { searchPane } from "./search";
import { stepsPane } from "./steps";
import { Tabs, type Tab } from "./tabs";
import { timeline } from "./timeline";
import { toolbar } from "./toolbar";

const WIDE = matchMedia("(min-width: 900px) and (min-height: 560px)");

export interface Page {
    scene: View3d;
    tabs: Tabs;
    contacts: Contacts;
    help: HTMLDialogElement;
}

export function buildPage(root: HTMLElement, model: Model): Page {
    const { view } = model;
    const viewport = h("main", { class: "viewport" });
    const side = h("aside", { class: "side", "aria-label": "Details" });
    const help = helpDialog();
    root.replaceChildren();
    root.className = `page${model.path ? "" : " without-path"}`;
    root.append(header(model, help), viewport, model.path ? timeline(model) : "", side, help);
    const scene = new View3d(viewport, model);
    viewport.append(toolbar(model, scene), captions(model, scene));
    const contacts = new Contacts(view, model.kinematics, scene.geometries);
    const graph = view.graph && view.graph.states.length > 0 ? graphPane(model, view.graph) : null;
    const problems = problemCount(model);
    const tabs: Tab[] = [];
    const add = (name: string, label: string, content: HTMLElement | null, badge = 0): void => {
        if (content) tabs.push({ name, label, content, badge });
    };
    if (problems > 0 && !model.path) add("problems", "Problems", problemsPane(model), problems);
    if (model.path) add("steps", "Steps", stepsPane(model));
    if (view.search) add("search", "Search", searchPane(model, scene, view.search));
    if (view.kind === "model") add("joints", "Joints", jointsPane(model, contacts));
    if (graph) add("graph", "Graph", h("div", {}));
    if (model.path) add("curves", "Curves", curvesPane(model));
    if (problems > 0 && model.path) add("problems", "Problems", problemsPane(model), problems);
    if (view.kind !== "model") add("joints", "Joints", jointsPane(model, contacts));
    add("about", "About", aboutPane(model));
    const shown = new Tabs(tabs);
    if (model.path?.data.refused?.length) shown.select("problems");
    if (view.kind === "search") shown.select("search");
    const pinned = h("section", { class: "pinned", "aria-label": "Constraint graph" });
    side.append(pinned, shown.root);
    if (graph) placeGraph(graph, pinned, shown);
    else pinned.hidden = true;
    return { scene, tabs: shown, contacts, help };
}

/** Beside the scene where there is room, else a tab. */
function placeGraph(graph: HTMLElement, pinned: HTMLElement, tabs: Tabs): void {
    const place = (): void => {
        const home = WIDE.matches ? pinned : tabs.pane("graph")!;
        home.append(graph);
        pinned.hidden = !WIDE.matches;
        tabs.hide("graph", WIDE.matches);
    };
    WIDE.addEventListener("change", place);
    place();
}

function header(model: Model, help: HTMLDialogElement): HTMLElement {
    const kinds = { path: "path", scene: "scene", model: "model", search: "search" };
    const dark = iconButton("moon", "Light or dark (T)", () => chooseTheme(theme.value === "dark" ? "light" : "dark"));
    theme.watch((value) => dark.replaceChildren(icon(value === "dark" ? "sun" : "moon")));
    return h(
        "header",
        { class: "header" },
        h("span", { class: "brand", "aria-hidden": "true" }, "Foliate"),
        h("h1", {}, model.view.title),
        h("span", { class: "kind" }, kinds[model.view.kind]),
        h("span", { class: "spring" }),
        dark,
        iconButton("help", "Help (?)", () => help.showModal()),
    );
}

/** What is shown, what is marked, what was clicked or measured: over the scene. */
function captions(model: Model, scene: View3d): HTMLElement {
    const state = h("div", { class: "caption caption-state" });
    const posed = h("span", {});
    const back = h("button", { type: "button", class: "link-button", onclick: () => model.clear() }, model.path ? "Back to the path" : "Back");
    const pose = h("div", { class: "caption caption-pose", role: "status" }, posed, back);
    const picked = h("div", { class: "caption caption-picked", role: "status" });
    const tell = (): void => {
        const words = model.mark.value?.words || model.posed.value;
        posed.textContent = words;
        pose.hidden = !words || (model.view.kind === "model" && !model.mark.value?.words && !model.posed.value);
        pose.classList.toggle("failing", !!model.mark.value);
        const segment = model.path?.segment(model.segment.value);
        state.textContent = segment && model.view.graph ? stateWords(model.view, segment.state) : "";
        state.hidden = !state.textContent || !!model.posed.value;
    };
    model.mark.watch(tell);
    model.posed.watch(tell);
    model.segment.watch(tell);
    const pick = (): void => {
        picked.textContent = scene.picking.measured.value || scene.picking.picked.value;
        picked.hidden = !picked.textContent;
    };
    scene.picking.picked.watch(pick);
    scene.picking.measured.watch(pick);
    return h("div", { class: "captions" }, state, pose, picked);
}
