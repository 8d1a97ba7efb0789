/** The help: keys, mouse, touch, colours. */
import { h, iconButton } from "../app/dom";
import { KEYS } from "../app/keys";

const GESTURES: [string, string][] = [
    ["Drag", "turn the view"],
    ["Right drag, two fingers", "move the view"],
    ["Wheel, pinch", "zoom"],
    ["Click a body", "tell its name"],
    ["Click a state of the graph", "go to its next visit"],
    ["Click a point of the roadmap", "show its configuration"],
];

export function helpDialog(): HTMLDialogElement {
    const rows = (list: [string, string][]): HTMLElement[] => list.flatMap(([key, words]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, words)]);
    const dialog = h("dialog", { class: "help", "aria-label": "Help" });
    dialog.append(
        h("header", {}, h("h2", {}, "Help"), iconButton("close", "Close", () => dialog.close())),
        h(
            "div",
            { class: "help-columns" },
            h("section", {}, h("h3", {}, "Keys"), h("dl", {}, ...rows(KEYS.map((key) => [key.shown, key.words])))),
            h("section", {}, h("h3", {}, "Mouse and touch"), h("dl", {}, ...rows(GESTURES)), h("h3", {}, "Timeline"), legend()),
        ),
    );
    dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
    return dialog;
}

function legend(): HTMLElement {
    const line = (mark: string, words: string): HTMLElement[] => [h("dt", {}, h("i", { class: `mark ${mark}` })), h("dd", {}, words)];
    return h(
        "dl",
        {},
        ...line("event-grasp", "something is grasped"),
        ...line("event-release", "something is released"),
        ...line("refused", "the check refuses the path here"),
        h("dt", {}, h("i", { class: "mark mark-colours" })),
        h("dd", {}, "one colour a state of the constraint graph"),
    );
}
