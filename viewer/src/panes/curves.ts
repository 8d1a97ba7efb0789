/** Curves over time: clearance, and each coordinate with its limits, as values or velocities. */
import { h } from "../app/dom";
import type { Model } from "../app/model";
import { length, pairName } from "../data/names";
import { sizeOf, velocitySizeOf } from "../motion/kinematics";
import { indexAt, type Path } from "../motion/path";
import { nearest } from "../scene/marks";
import { chart, type Chart, type Series } from "./chart";

type Kind = "position" | "velocity";

export function curvesPane(model: Model): HTMLElement {
    const path = model.path!;
    const list = h("div", { class: "charts" });
    const kind = h("select", { "aria-label": "What is drawn" }, h("option", { value: "position" }, "values"), h("option", { value: "velocity" }, "velocities"));
    const moving = h("input", { type: "checkbox", checked: true });
    const filter = h("input", { type: "search", placeholder: "Filter by name", "aria-label": "Filter by name" });
    let charts: Chart[] = [];
    let made = false;
    const move = (): void => {
        if (list.offsetParent === null) return;
        const k = indexAt(path.times, model.time.value);
        for (const one of charts) one.at(model.time.value, k);
    };
    const make = (): void => {
        made = true;
        const all = kind.value === "velocity" ? velocities(model, path) : positions(model, path);
        const wanted = all.filter((s) => s.name.toLowerCase().includes(filter.value.toLowerCase()) && (!moving.checked || moves(s)));
        charts = wanted.map((series) => chart(series, (t) => model.setTime(t)));
        list.replaceChildren(...charts.map((one) => one.root), charts.length === 0 ? h("p", { class: "quiet" }, "Nothing to draw.") : "");
        move();
    };
    // The first time that the pane is seen.
    new IntersectionObserver((entries) => {
        if (entries.some((entry) => entry.isIntersecting) && !made) make();
        move();
    }).observe(list);
    for (const input of [kind, moving, filter]) input.addEventListener("input", make);
    model.time.watch(move);
    return h(
        "div",
        {},
        clearance(model, path),
        h("div", { class: "fields" }, path.velocities ? kind : null, filter, h("label", { class: "check" }, moving, "only what moves")),
        list,
    );
}

function moves(series: Series): boolean {
    const first = series.value(0);
    for (let k = 1; k < series.times.length; k++) if (Math.abs(series.value(k) - first) > 1e-5) return true;
    return false;
}

function positions(model: Model, path: Path): Series[] {
    const { view } = model;
    const n = view.coordinates.length;
    return view.joints.flatMap((joint) => {
        const first = joint.q;
        if (first === null || first === undefined) return [];
        return Array.from({ length: sizeOf(joint) }, (_, i): Series => {
            const isAngle = joint.type === "revolute" || (joint.type === "planar" && i === 2);
            return {
                name: view.coordinates[first + i] ?? joint.name,
                times: path.times,
                value: (k) => path.configurations[k * n + first + i]!,
                duration: path.duration,
                lower: joint.lower?.[i] ?? null,
                upper: joint.upper?.[i] ?? null,
                unit: isAngle ? "rad" : joint.type === "freeflyer" && i > 2 ? "" : "m",
                colour: "position",
            };
        });
    });
}

function velocities(model: Model, path: Path): Series[] {
    const values = path.velocities;
    if (!values) return [];
    const parts = ["x", "y", "z", "about x", "about y", "about z"];
    return model.view.joints.flatMap((joint) => {
        const first = joint.v;
        if (first === null || first === undefined) return [];
        const size = velocitySizeOf(joint);
        return Array.from({ length: size }, (_, i): Series => {
            const isTurn = joint.type === "revolute" || i > 2 || (joint.type === "planar" && i === 2);
            const limit = size === 1 ? (joint.velocity ?? null) : null;
            return {
                name: size === 1 ? joint.name : `${joint.name} ${size === 3 && i === 2 ? "turn" : parts[i]}`,
                times: path.times,
                value: (k) => values[k * path.velocitySize + first + i]!,
                duration: path.duration,
                lower: limit === null ? null : -limit,
                upper: limit,
                unit: isTurn ? "rad/s" : "m/s",
                colour: "velocity" as Kind,
            };
        });
    });
}

function clearance(model: Model, path: Path): HTMLElement | null {
    const data = path.clearance;
    if (!data || data.times.length === 0) return null;
    const told = h("p", { class: "quiet" });
    const series: Series = {
        name: "Clearance",
        times: data.times,
        value: (k) => data.values[k]!,
        duration: path.duration,
        lower: 0,
        upper: null,
        unit: "m",
        colour: "clearance",
    };
    const one = chart(series, (t) => model.setTime(t));
    const least = data.values.reduce((best, value, k) => (value < data.values[best]! ? k : best), 0);
    model.time.watch((t) => {
        const k = nearest(data.times, t);
        one.at(t, k);
        const pair = data.pairs[data.pair[k]!];
        told.textContent = pair ? `Closest: ${pairName(model.view, pair)}, ${length(data.values[k]!)}` : "";
    });
    const show = h("input", { type: "checkbox", onchange: () => model.toggle("clearance", show.checked) });
    model.switches.clearance.watch((on) => (show.checked = on));
    const jump = h(
        "button",
        { type: "button", class: "link-button", onclick: () => (model.toggle("clearance", true), model.setTime(data.times[least]!)) },
        `Go to the least, ${length(data.values[least]!)}`,
    );
    return h("div", { class: "clearance" }, one.root, told, h("div", { class: "fields" }, h("label", { class: "check" }, show, "draw the closest pair"), jump));
}
