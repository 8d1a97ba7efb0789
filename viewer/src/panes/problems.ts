/** What is wrong: collisions and violations of the start or goal, places that the check refuses, warnings of the models. */
import { h } from "../app/dom";
import type { Mark, Model } from "../app/model";
import type { Collision, Vec3, Violation, Where } from "../data/document";
import { degrees, length, pairName, seconds } from "../data/names";

/** A turn that is not told, radians: as many degrees as `degrees` rounds to nothing. */
const SMALL_TURN = 1e-3;

/** Failures, and warnings of the models. */
export function problemCounts({ view }: Model): { failures: number; warnings: number } {
    const failures = (view.collisions?.length ?? 0) + (view.violations?.length ?? 0) + (view.path?.refused?.length ?? 0);
    return { failures, warnings: view.warnings?.length ?? 0 };
}

export function problemsPane(model: Model): HTMLElement {
    const { view } = model;
    const refused = (view.path?.refused ?? []).map((place) =>
        finding(place.time === null || place.time === undefined ? "The file as a whole" : `At ${seconds(place.time)}`, place.words, () => {
            model.setTime(place.time ?? model.time.value);
            model.mark.set({ links: place.links ?? [], points: [], number: "", words: place.words });
        }),
    );
    const collisions = (view.collisions ?? []).map((c) => {
        const words = c.words || pairName(view, c.links);
        return finding(where(c.configuration), words, () => model.show(c.configuration, collisionMark(c, words)));
    });
    const violations = (view.violations ?? []).map((v) => finding(where(v.configuration), v.words, () => model.show(v.configuration, violationMark(v))));
    const warnings = (view.warnings ?? []).map((text) => h("li", { class: "warning" }, text));
    return h(
        "div",
        { class: "problems" },
        section("Refused by the check", refused),
        section("Collisions", collisions),
        section("Violated constraints and limits", violations),
        warnings.length > 0 ? h("section", {}, h("h3", {}, "Warnings"), h("ul", {}, ...warnings)) : null,
    );
}

function section(title: string, findings: HTMLElement[]): HTMLElement | null {
    return findings.length > 0 ? h("section", {}, h("h3", {}, title), ...findings) : null;
}

/** The words name the numbers too; the scene shows the number where it is. */
function finding(place: string, words: string, onclick: () => void): HTMLElement {
    return h(
        "button",
        { type: "button", class: "finding", onclick },
        h("span", { class: "finding-place" }, place),
        h("span", {}, words),
    );
}

function where(configuration: Where): string {
    return configuration === "start" ? "At the start" : configuration === "goal" ? "At the goal" : "In a configuration";
}

function collisionMark(collision: Collision, words: string): Mark {
    const { depth, distance } = collision;
    const number = depth ? `${length(depth)} deep` : distance ? `${length(distance)} apart` : "";
    return { links: [...collision.links], points: collision.points ?? (collision.point ? [collision.point] : []), number, words };
}

function violationMark(violation: Violation): Mark {
    const points = violation.points ?? [];
    const number = violation.points ? off(violation.points, violation.angle ?? 0) : numbers(violation);
    return { links: violation.links ?? [], points, number, words: violation.words };
}

/** How far something is from where it would have to be. */
function off([here, there]: [Vec3, Vec3], angle: number): string {
    const way = length(Math.hypot(there[0] - here[0], there[1] - here[1], there[2] - here[2]));
    return angle > SMALL_TURN ? `${way}, ${degrees(angle)} off` : `${way} off`;
}

function numbers({ value, limit }: Violation): string {
    const digits = (v: number): string => String(Number(v.toPrecision(3)));
    if (value === null || value === undefined) return "";
    return limit === null || limit === undefined ? digits(value) : `${digits(value)}, allowed ${digits(limit)}`;
}
