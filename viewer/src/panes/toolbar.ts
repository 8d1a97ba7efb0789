/** Buttons over the scene: camera presets, what is shown, measuring. Each menu is a popover that Escape closes. */
import { h, iconButton, icon, type Icon } from "../app/dom";
import { SWITCHES, type Model, type SwitchName } from "../app/model";
import type { View3d } from "../scene/view3d";
import { VIEWS, type ViewName } from "../scene/views";

export function toolbar(model: Model, scene: View3d): HTMLElement {
    const presets = (Object.keys(VIEWS) as ViewName[]).map((name, i) =>
        h("button", { type: "button", class: "menu-item", onclick: () => scene.views.look(name) }, h("span", {}, name), h("kbd", {}, String(i + 1))),
    );
    const measure = iconButton("ruler", "Measure between two points (M)", () => model.measuring.set(!model.measuring.value), { "aria-pressed": "false" });
    model.measuring.watch((on) => measure.setAttribute("aria-pressed", String(on)));
    return h(
        "div",
        { class: "toolbar", role: "toolbar", "aria-label": "View" },
        iconButton("fit", "Fit the scene into the picture (0)", () => scene.views.look(null)),
        menu("camera", "Camera", presets, true),
        menu("layers", "What is shown", switches(model), false),
        measure,
    );
}

/** Only switches that have something to show. */
function switches(model: Model): HTMLElement[] {
    const { view, path } = model;
    const features = view.documents ?? {};
    const has: Partial<Record<SwitchName, boolean>> = {
        start: !!view.start,
        goal: !!view.goal,
        clearance: !!path?.clearance,
        grippers: !!features.grippers?.length,
        handles: !!features.handles?.length,
        surfaces: !!features.surfaces?.length,
        roadmap: !!view.search?.count,
    };
    has.names = !!(has.grippers || has.handles || has.surfaces);
    return (Object.entries(SWITCHES) as [SwitchName, string][])
        .filter(([name]) => has[name] ?? true)
        .map(([name, words]) => {
            const box = h("input", { type: "checkbox", "data-switch": name, onchange: () => model.toggle(name, box.checked) });
            model.switches[name].watch((on) => (box.checked = on));
            const swatch = name === "start" || name === "goal" || name === "collision" ? h("i", { class: `swatch swatch-${name}` }) : null;
            return h("label", { class: "menu-item check" }, box, h("span", {}, words), swatch);
        });
}

function menu(name: Icon, label: string, items: HTMLElement[], closes: boolean): HTMLElement {
    const list = h("div", { class: "menu", hidden: true }, ...items);
    const button = h("button", { type: "button", class: "icon-button", "aria-label": label, title: label, "aria-expanded": "false" }, icon(name));
    const root = h("div", { class: "menu-root" }, button, list);
    const open = (on: boolean): void => {
        list.hidden = !on;
        button.setAttribute("aria-expanded", String(on));
    };
    button.addEventListener("click", () => open(list.hidden === true));
    if (closes) list.addEventListener("click", () => open(false));
    document.addEventListener("pointerdown", (event) => {
        if (!root.contains(event.target as Node)) open(false);
    });
    root.addEventListener("keydown", (event) => {
        if (event.key !== "Escape" || list.hidden) return;
        event.stopPropagation();
        open(false);
        button.focus();
    });
    return root;
}
