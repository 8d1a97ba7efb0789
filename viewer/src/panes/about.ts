/** Facts about what is shown: names, sizes, how it was planned. */
import { h } from "../app/dom";
import type { Model } from "../app/model";
import { count, length } from "../data/names";

export function aboutPane(model: Model): HTMLElement {
    const { view } = model;
    const triangles = view.meshes.reduce((sum, mesh) => sum + mesh.triangles, 0);
    const ofKind = (kind: string): string => view.parts.filter((part) => part.kind === kind).map((part) => part.name).join(", ");
    const facts: [string, string][] = [
        ...(view.facts ?? []),
        ["robots", ofKind("robot")],
        ["objects", ofKind("object")],
        ["environment", ofKind("environment")],
        ["links", count(view.links.length)],
        ["joints that move", count(view.joints.length)],
        ["numbers of a configuration", count(view.coordinates.length)],
        ["triangles of meshes", triangles === 0 ? "" : view.triangles && view.triangles[0] > triangles ? `${count(triangles)} of ${count(view.triangles[0])}` : count(triangles)],
        ["shown meshes are off by", view.deviation ? `at most ${length(view.deviation)}` : ""],
        ["verdict of the check", view.path?.verdict ?? ""],
    ];
    if (view.graph) facts.push(["states and transitions", `${count(view.graph.states.length)} and ${count(view.graph.transitions.length)}`]);
    const shown = facts.filter(([, value]) => value);
    return h(
        "div",
        {},
        h("dl", { class: "facts" }, ...shown.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)])),
        triangles === 0 ? null : h("p", { class: "quiet" }, "Meshes have the colours of their model; textures are not shown."),
        h("p", { class: "quiet" }, "One file, made by foliate view. It loads nothing from the network. It contains three.js (MIT); the licence is in its source."),
    );
}
