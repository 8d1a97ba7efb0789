/** The funnel of a search: per transition what was tried, projected, free and reached, and the pairs that collided. */
import { h } from "../app/dom";
import type { Model } from "../app/model";
import type { FunnelPair, FunnelRow } from "../data/document";
import { count, length, pairName, transitionWords } from "../data/names";

const STAGES = ["tried", "projected", "free", "reached"] as const;
/** Rows that are shown before a person asks for more. */
const FIRST = 40;

export function funnel(model: Model, rows: FunnelRow[]): HTMLElement {
    const sorted = [...rows].sort((a, b) => b.tried - a.tried || a.transition - b.transition);
    const most = Math.max(...sorted.map((row) => row.tried), 1);
    const list = h("div", { class: "funnel" });
    const add = (from: number, to: number): void => list.append(...sorted.slice(from, to).map((row) => rowElement(model, row, most)));
    add(0, FIRST);
    if (sorted.length > FIRST) {
        const more = h("button", { type: "button", class: "link-button", onclick: () => (more.remove(), add(FIRST, sorted.length)) }, `Show ${sorted.length - FIRST} more`);
        list.after(more);
        return h("div", {}, key(), list, more);
    }
    return h("div", {}, key(), list);
}

function key(): HTMLElement {
    const words = { tried: "tried", projected: "projected", free: "free of collision", reached: "reached" };
    return h("div", { class: "funnel-key" }, ...STAGES.map((stage) => h("span", {}, h("i", { class: `bar-${stage}` }), words[stage])));
}

function rowElement(model: Model, row: FunnelRow, most: number): HTMLElement {
    const name = row.words || transitionWords(model.view, row.transition);
    const bars = STAGES.map((stage) => {
        const bar = h("div", { class: `funnel-bar bar-${stage}` });
        // A root keeps rare successes visible beside many attempts.
        bar.style.width = `${(100 * Math.sqrt(row[stage] / most)).toFixed(2)}%`;
        return h("div", { class: "funnel-line" }, bar, h("span", {}, count(row[stage])));
    });
    const pairs = row.pairs ?? [];
    const head = h("div", { class: "funnel-name" }, name);
    const counts = h("div", { class: "funnel-bars", role: "img", "aria-label": STAGES.map((s) => `${s} ${row[s]}`).join(", ") }, ...bars);
    if (pairs.length === 0) return h("div", { class: "funnel-row" }, head, counts);
    const summary = h("summary", {}, `${pairs.length} ${pairs.length === 1 ? "pair" : "pairs"} collided`);
    return h("div", { class: "funnel-row" }, head, counts, h("details", {}, summary, ...pairs.map((pair) => pairButton(model, pair))));
}

function pairButton(model: Model, pair: FunnelPair): HTMLElement {
    const words = pairName(model.view, pair.links);
    const shown = pair.configuration ? "" : " (no configuration was kept)";
    const depth = pair.depth ? `, ${length(pair.depth)} deep` : "";
    return h(
        "button",
        {
            type: "button",
            class: "pair",
            title: `Show a configuration where they collided${shown}`,
            onclick: () => model.show(pair.configuration, { links: [...pair.links], points: [], number: "", words: `${words} collided${depth}` }),
        },
        h("span", {}, words),
        h("span", { class: "pair-count" }, count(pair.count)),
    );
}
