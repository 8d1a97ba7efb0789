/** The path as a list: each segment in words, with what is grasped and released in it. */
import { groupColour } from "../app/colours";
import { h } from "../app/dom";
import type { Model } from "../app/model";
import { theme } from "../app/theme";
import type { Segment } from "../data/document";
import { seconds, stateWords } from "../data/names";

export function stepsPane(model: Model): HTMLElement {
    const path = model.path!;
    const events = path.data.events ?? [];
    const chips: [HTMLElement, number][] = [];
    const row = (segment: Segment, i: number): HTMLElement => {
        const chip = h("span", { class: "chip", "aria-hidden": "true" });
        chips.push([chip, segment.colour]);
        // What happens where two segments meet belongs to the one that it ends.
        const within = events.filter((e) => (e.time > segment.from + 1e-9 || i === 0) && e.time <= segment.to + 1e-9);
        return h(
            "li",
            {},
            h(
                "button",
                { type: "button", class: "step", onclick: () => model.setTime(segment.from) },
                chip,
                h("span", { class: "step-words" }, segment.words, h("span", { class: "step-state" }, segment.waypoint || stateWords(model.view, segment.state))),
                h("span", { class: "step-time" }, seconds(segment.from)),
            ),
            ...within.map((event) => h("div", { class: `step-event event-text-${event.kind}` }, event.words)),
        );
    };
    const rows = path.data.segments.map(row);
    const list = h("ol", { class: "steps" }, ...rows);
    model.segment.watch((at) => {
        rows.forEach((element, i) => {
            element.classList.toggle("active", i === at);
            element.toggleAttribute("aria-current", i === at);
        });
        const active = rows[at];
        if (!active || list.offsetParent === null) return;
        // Only the pane scrolls, never the page around it.
        const pane = list.closest(".pane");
        if (!pane) return;
        const top = active.offsetTop - pane.clientHeight / 3;
        if (active.offsetTop < pane.scrollTop || active.offsetTop + active.offsetHeight > pane.scrollTop + pane.clientHeight) pane.scrollTop = top;
    });
    theme.watch((value) => chips.forEach(([chip, group]) => (chip.style.background = groupColour(group, value))));
    return list;
}
