/** A slider for each joint of one or three numbers; the links that collide in the configuration that is shown. */
import { h } from "../app/dom";
import type { Model } from "../app/model";
import { pairName } from "../data/names";
import { sizeOf } from "../motion/kinematics";
import type { Contacts } from "../collide/contacts";

/** Sliders that are shown before a person filters. */
const MOST = 80;

interface Slider {
    root: HTMLElement;
    name: string;
    show(configuration: ArrayLike<number>): void;
}

export function jointsPane(model: Model, contacts: Contacts): HTMLElement {
    const sliders = model.view.joints.flatMap((joint): Slider[] => {
        const first = joint.q;
        if (first === null || first === undefined || joint.type === "freeflyer") return [];
        return Array.from({ length: sizeOf(joint) }, (_, i) => {
            const isAngle = joint.type === "revolute" || i === 2;
            const reach = isAngle ? Math.PI : 2;
            const low = joint.lower?.[i] ?? -reach;
            const high = joint.upper?.[i] ?? reach;
            return slider(model, model.view.coordinates[first + i] ?? joint.name, first + i, low, high, isAngle);
        });
    });
    const filter = h("input", { type: "search", placeholder: "Filter by name", "aria-label": "Filter joints by name" });
    const list = h("div", { class: "sliders" });
    const fill = (): void => {
        const wanted = sliders.filter((s) => s.name.toLowerCase().includes(filter.value.toLowerCase()));
        const more = wanted.length - MOST;
        list.replaceChildren(...wanted.slice(0, MOST).map((s) => s.root), more > 0 ? h("p", { class: "quiet" }, `${more} more: filter by name.`) : "");
    };
    fill();
    filter.addEventListener("input", fill);
    let shown = false;
    const show = (): void => {
        if (shown) for (const one of sliders) one.show(model.configuration.value);
    };
    model.configuration.watch(show);
    new IntersectionObserver((entries) => {
        shown = entries.some((entry) => entry.isIntersecting);
        show();
    }).observe(list);
    const isModel = model.view.kind === "model";
    return h(
        "div",
        {},
        contacts.pairs.length > 0 ? contactsPart(model, contacts) : null,
        sliders.length > 12 ? h("div", { class: "fields" }, filter) : null,
        list,
        sliders.length === 0 ? h("p", { class: "quiet" }, "Nothing here moves by joints of its own.") : null,
        isModel ? null : h("p", { class: "quiet" }, "A joint that you move leaves the path; play returns to it. What is held does not follow."),
    );
}

function slider(model: Model, name: string, index: number, low: number, high: number, isAngle: boolean): Slider {
    const show = (value: number): string => (isAngle ? `${value.toFixed(3)} rad, ${((value * 180) / Math.PI).toFixed(1)}\u00b0` : `${value.toFixed(4)} m`);
    const value = h("output", {});
    const step = Math.max((high - low) / 1000, 1e-6);
    const input = h("input", { type: "range", min: low, max: high, step, "aria-label": name, disabled: low >= high });
    input.addEventListener("input", () => {
        const q = Float64Array.from(model.configuration.value);
        q[index] = Number(input.value);
        model.mark.set(null);
        model.pose(q, "A configuration of the sliders");
    });
    const root = h("label", { class: "slider" }, h("span", { class: "slider-name" }, name), value, input);
    let last = NaN;
    return {
        root,
        name,
        show(configuration) {
            const now = configuration[index] ?? 0;
            if (now === last) return;
            last = now;
            input.value = String(now);
            value.textContent = show(now);
        },
    };
}

/** Tests once a frame at most, and only while it is wanted. */
function contactsPart(model: Model, contacts: Contacts): HTMLElement {
    const on = h("input", { type: "checkbox", checked: model.view.kind === "model" });
    const told = h("p", { role: "status" });
    const list = h("div", {});
    let scheduled = 0;
    let last = "";
    const test = (): void => {
        scheduled = 0;
        const found = on.checked ? contacts.now() : [];
        const names = found.map((pair) => pairName(model.view, pair));
        const text = names.join("\n");
        told.textContent = !on.checked ? "" : found.length === 0 ? "No links collide now." : `${found.length} ${found.length === 1 ? "pair collides" : "pairs collide"} now:`;
        told.classList.toggle("failing", found.length > 0);
        if (text !== last) list.replaceChildren(...names.slice(0, 30).map((name) => h("div", { class: "pair-now" }, name)));
        if (model.view.kind === "model" && text !== last) {
            model.mark.set(found.length > 0 ? { links: [...new Set(found.flat())], points: [], number: "", words: "" } : null);
        }
        last = text;
    };
    const ask = (): void => {
        if (!scheduled) scheduled = requestAnimationFrame(test);
    };
    model.configuration.watch(() => on.checked && ask());
    on.addEventListener("change", ask);
    return h("div", { class: "contacts" }, h("label", { class: "check" }, on, "test which links collide"), told, list);
}
