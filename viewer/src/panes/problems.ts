/** What is wrong: collisions and violations of the start or goal, places that the check refuses, warnings of the models. */
import { h } from "../app/dom";
import type { Mark, Model } from "../app/model";
import type { Collision, Violation, Where } from "../data/document";
import { length, pairName, seconds } from "../data/names";

export function problemCount(model: Model): number {
    const { view } = model;
    return (view.collisions?.length ?? 0) + (view.violations?.length ?? 0) + (view.path?.refused?.length ?? 0) + (view.warnings?.length ?? 0);
}

export function problemsPane(model: Model): HTMLElement {
    const { view } = model;
    const refused = (view.path?.refused ?? []).map((place) =>
        finding(`At ${seconds(place.time)}`, place.words, "", () => {
            model.setTime(place.time);
            model.mark.set({ links: place.links ?? [], points: [], number: "", words: place.words });
        }),
    );
    const collisions = (view.collisions ?? []).map((c) => {
        const words = c.words || pairName(view, c.links);
        return finding(where(c.configuration), words, c.depth ? `${length(c.depth)} deep` : "", () => model.show(c.configuration, collisionMark(c, words)));
    });
    const violations = (view.violations ?? []).map((v) => finding(where(v.configuration), v.words, numbers(v), () => model.show(v.configuration, violationMark(v))));
    const warnings = (view.warnings ?? []).map((text) => h("li", { class: "warning" }, text));
    return h(
        "div",
        { class: "problems" },
        section("Refused by the check", refused),
        section("Collisions", collisions),
        section("Violated constraints and limits", violations),
        warnings.length > 0 ? h("section", {}, h("h3", {}, "Warnings"), h("ul", {}, ...warnings)) : null,
        problemCount(model) === 0 ? h("p", { class: "quiet" }, "Nothing is wrong.") : null,
    );
}

function section(title: string, findings: HTMLElement[]): HTMLElement | null {
    return findings.length > 0 ? h("section", {}, h("h3", {}, title), ...findings) : null;
}

function finding(place: string, words: string, number: string, onclick: () => void): HTMLElement {
    return h(
        "button",
        { type: "button", class: "finding", onclick },
        h("span", { class: "finding-place" }, place),
        h("span", {}, words),
        number ? h("span", { class: "finding-number" }, number) : null,
    );
}

function where(configuration: Where): string {
    return configuration === "start" ? "At the start" : configuration === "goal" ? "At the goal" : "In a configuration";
}

function collisionMark(collision: Collision, words: string): Mark {
    const number = collision.depth ? `${length(collision.depth)} deep` : "";
    const points = collision.points ?? (collision.point ? [collision.point] : []);
    return { links: [...collision.links], points, number, words: number ? `${words}, ${number}` : words };
}

function violationMark(violation: Violation): Mark {
    const number = numbers(violation);
    return { links: violation.links ?? [], points: violation.points ?? [], number, words: number ? `${violation.words}: ${number}` : violation.words };
}

function numbers({ value, limit }: Violation): string {
    const digits = (v: number): string => String(Number(v.toPrecision(3)));
    if (value === null || value === undefined) return "";
    return limit === null || limit === undefined ? digits(value) : `${digits(value)}, allowed ${digits(limit)}`;
}
