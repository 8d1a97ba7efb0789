/** How things of a document are named to people. */
import type { LinkPair, ViewDocument } from "./document";

export function linkName(view: ViewDocument, link: number): string {
    return view.links[link]?.name ?? `link ${link}`;
}

export function pairName(view: ViewDocument, [a, b]: LinkPair): string {
    return `${linkName(view, a)} and ${linkName(view, b)}`;
}

/** Empty where the graph does not show the state. */
export function stateWords(view: ViewDocument, state: number | null): string {
    const found = view.graph?.states[state ?? -1];
    return found ? found.words || found.name : "";
}

export function transitionWords(view: ViewDocument, transition: number | null | undefined): string {
    const found = view.graph?.transitions[transition ?? -1];
    return found ? found.words || found.name : "a transition that is not shown";
}

/** Metres, in the unit that keeps three or four digits. */
export function length(metres: number): string {
    const size = Math.abs(metres);
    if (size < 0.0095) return `${(metres * 1000).toFixed(2)} mm`;
    if (size < 1) return `${(metres * 1000).toFixed(0)} mm`;
    return `${metres.toFixed(3)} m`;
}

/** Radians, in degrees. */
export function degrees(radians: number): string {
    return `${((radians * 180) / Math.PI).toFixed(1)}\u00b0`;
}

export function seconds(time: number): string {
    return time < 60 ? time.toFixed(2) : `${Math.floor(time / 60)}:${(time % 60).toFixed(1).padStart(4, "0")}`;
}

export function count(n: number): string {
    return n.toLocaleString("en").replaceAll(",", "\u2009");
}
