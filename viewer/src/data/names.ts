/** How things of a document are named to people. */
import type { LinkPair, ViewDocument } from "./document";

export function linkName(view: ViewDocument, link: number): string {
    return view.links[link]?.name ?? `link ${link}`;
}

export function pairName(view: ViewDocument, [a, b]: LinkPair): string {
    return `${linkName(view, a)} and ${linkName(view, b)}`;
}

export function stateWords(view: ViewDocument, state: number): string {
    const found = view.graph?.states[state];
    return found ? found.words || found.name : `state ${state}`;
}

export function transitionWords(view: ViewDocument, transition: number): string {
    const found = view.graph?.transitions[transition];
    return found ? found.words || found.name : `transition ${transition}`;
}

/** Metres, in the unit that keeps three or four digits. */
export function length(metres: number): string {
    const size = Math.abs(metres);
    if (size < 0.0095) return `${(metres * 1000).toFixed(2)} mm`;
    if (size < 1) return `${(metres * 1000).toFixed(0)} mm`;
    return `${metres.toFixed(3)} m`;
}

export function seconds(time: number): string {
    return time < 60 ? time.toFixed(2) : `${Math.floor(time / 60)}:${(time % 60).toFixed(1).padStart(4, "0")}`;
}

export function count(n: number): string {
    return n.toLocaleString("en").replaceAll(",", "\u2009");
}
