/** Transport and timeline: segments coloured by state, grasps and releases, refused places, the playhead. */
import { groupColour } from "../app/colours";
import { h, icon, iconButton } from "../app/dom";
import type { Model } from "../app/model";
import { theme } from "../app/theme";
import type { PathEvent } from "../data/document";
import { seconds, stateWords } from "../data/names";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export function timeline(model: Model): HTMLElement {
    return h("section", { class: "timeline", "aria-label": "Timeline" }, transport(model), track(model));
}

function transport(model: Model): HTMLElement {
    const play = iconButton("play", "Play (space)", () => model.play(), { class: "icon-button primary" });
    model.playing.watch((playing) => {
        play.replaceChildren(icon(playing ? "pause" : "play"));
        const label = playing ? "Pause (space)" : "Play (space)";
        play.setAttribute("aria-label", label);
        play.title = label;
    });
    const speed = h(
        "select",
        { "aria-label": "Speed", title: "Speed", onchange: () => model.speed.set(Number(speed.value)) },
        ...SPEEDS.map((value) => h("option", { value, selected: value === 1 }, `${value}×`)),
    );
    model.speed.watch((value) => (speed.value = String(value)));
    const clock = h("output", { class: "clock", "aria-label": "Time" });
    const unit = model.path?.data.timed ? " s" : "";
    const end = seconds(model.duration);
    model.time.watch((t) => (clock.textContent = `${seconds(t)} / ${end}${unit}`));
    if (!model.path?.data.timed) clock.title = "The path has no times: it moves one unit of length a second.";
    const words = h("span", { class: "now-words" });
    const chip = h("span", { class: "chip", "aria-hidden": "true" });
    const tell = (): void => {
        const segment = model.path?.segment(model.segment.value);
        words.textContent = segment?.words ?? "";
        chip.style.background = segment ? groupColour(segment.colour, theme.value) : "";
    };
    model.segment.watch(tell);
    theme.watch(tell);
    return h(
        "div",
        { class: "transport" },
        iconButton("previous", "Previous segment (,)", () => model.step(-1)),
        play,
        iconButton("next", "Next segment (.)", () => model.step(1)),
        speed,
        h("span", { class: "now" }, chip, words),
        clock,
    );
}

function track(model: Model): HTMLElement {
    const path = model.path!;
    const duration = Math.max(model.duration, 1e-9);
    const percent = (t: number): string => `${((100 * t) / duration).toFixed(3)}%`;
    const segments = path.data.segments.map((segment, i) => {
        const state = stateWords(model.view, segment.state);
        const element = h("div", { class: "segment", title: `${i + 1}. ${segment.words}\n${state}, ${seconds(segment.from)} to ${seconds(segment.to)}` });
        element.style.left = percent(segment.from);
        element.style.width = percent(segment.to - segment.from);
        return element;
    });
    theme.watch((value) => {
        segments.forEach((element, i) => (element.style.background = groupColour(path.data.segments[i]!.colour, value)));
    });
    model.segment.watch((at) => segments.forEach((element, i) => element.classList.toggle("active", i === at)));
    const refused = (path.data.refused ?? []).map((place) => {
        const element = h("button", {
            type: "button",
            class: "refused",
            title: place.words,
            "aria-label": `Refused at ${seconds(place.time)}: ${place.words}`,
            onclick: () => {
                model.setTime(place.time);
                model.mark.set({ links: place.links ?? [], points: [], number: "", words: place.words });
            },
        });
        element.style.left = percent(place.time);
        return element;
    });
    const head = h("div", { class: "playhead" });
    const bar = h("div", { class: "bar" }, ...segments);
    const slider = h(
        "div",
        {
            class: "track",
            role: "slider",
            tabindex: 0,
            "aria-label": "Time on the path",
            "aria-valuemin": 0,
            "aria-valuemax": duration.toFixed(2),
        },
        h("div", { class: "events" }, ...(path.data.events ?? []).map((event) => eventMark(event, percent(event.time), model))),
        bar,
        head,
        ...refused,
    );
    model.time.watch((t) => {
        head.style.left = percent(t);
        slider.setAttribute("aria-valuenow", t.toFixed(2));
        slider.setAttribute("aria-valuetext", `${seconds(t)}, ${path.segment(path.segmentAt(t))?.words ?? ""}`);
    });
    scrub(slider, bar, model);
    return slider;
}

/** A triangle down where something is grasped, up where it is released, a dot for all else. */
function eventMark(event: PathEvent, left: string, model: Model): HTMLElement {
    const kind = event.kind === "grasp" || event.kind === "release" ? event.kind : "other";
    const mark = h("button", {
        type: "button",
        class: `event event-${kind}`,
        title: `${seconds(event.time)}  ${event.words}`,
        "aria-label": `${event.words}, at ${seconds(event.time)}`,
        tabindex: -1,
        onclick: () => model.setTime(event.time),
    });
    mark.style.left = left;
    return mark;
}

function scrub(slider: HTMLElement, bar: HTMLElement, model: Model): void {
    const to = (event: PointerEvent): void => {
        const box = bar.getBoundingClientRect();
        model.setTime(((event.clientX - box.left) / box.width) * model.duration);
    };
    slider.addEventListener("pointerdown", (event) => {
        if ((event.target as Element).closest("button")) return;
        slider.setPointerCapture(event.pointerId);
        model.playing.set(false);
        model.mark.set(null);
        to(event);
    });
    slider.addEventListener("pointermove", (event) => {
        if (slider.hasPointerCapture(event.pointerId)) to(event);
    });
}
