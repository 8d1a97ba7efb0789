/** Keys: one table for the keyboard and the help. */

export interface Actions {
    play(): void;
    seek(seconds: number): void;
    step(by: 1 | -1): void;
    end(at: "start" | "end"): void;
    faster(by: 1 | -1): void;
    toggle(name: "visual" | "collision" | "grippers" | "surfaces" | "frames" | "names" | "ghosts" | "clearance" | "roadmap" | "ground"): void;
    view(index: number): void;
    fit(): void;
    measure(): void;
    theme(): void;
    help(): void;
    escape(): void;
}

interface Key {
    shown: string;
    words: string;
    keys: Record<string, (actions: Actions) => void>;
}

export const KEYS: Key[] = [
    { shown: "Space", words: "play or pause", keys: { " ": (a) => a.play() } },
    { shown: "← →", words: "0.1 s back or forth", keys: { ArrowLeft: (a) => a.seek(-0.1), ArrowRight: (a) => a.seek(0.1) } },
    { shown: "Shift ← →", words: "1 s back or forth", keys: { "Shift+ArrowLeft": (a) => a.seek(-1), "Shift+ArrowRight": (a) => a.seek(1) } },
    { shown: ", .", words: "previous or next segment", keys: { ",": (a) => a.step(-1), ".": (a) => a.step(1) } },
    { shown: "Home End", words: "start or end", keys: { Home: (a) => a.end("start"), End: (a) => a.end("end") } },
    { shown: "+ −", words: "faster or slower", keys: { "+": (a) => a.faster(1), "=": (a) => a.faster(1), "-": (a) => a.faster(-1) } },
    { shown: "1 … 6", words: "corner, front, back, left, right, top", keys: Object.fromEntries([0, 1, 2, 3, 4, 5].map((i) => [String(i + 1), (a: Actions) => a.view(i)])) },
    { shown: "0", words: "fit the scene into the picture", keys: { "0": (a) => a.fit() } },
    { shown: "V C", words: "visual or collision geometry", keys: { v: (a) => a.toggle("visual"), c: (a) => a.toggle("collision") } },
    { shown: "G", words: "grippers and handles", keys: { g: (a) => a.toggle("grippers") } },
    { shown: "S F N", words: "surfaces, frames, names", keys: { s: (a) => a.toggle("surfaces"), f: (a) => a.toggle("frames"), n: (a) => a.toggle("names") } },
    { shown: "B", words: "ghosts of start and goal", keys: { b: (a) => a.toggle("ghosts") } },
    { shown: "D", words: "closest pair", keys: { d: (a) => a.toggle("clearance") } },
    { shown: "R", words: "roadmap of the search", keys: { r: (a) => a.toggle("roadmap") } },
    { shown: "L", words: "ground grid", keys: { l: (a) => a.toggle("ground") } },
    { shown: "M", words: "measure between two points", keys: { m: (a) => a.measure() } },
    { shown: "T", words: "light or dark", keys: { t: (a) => a.theme() } },
    { shown: "?", words: "this help", keys: { "?": (a) => a.help() } },
    { shown: "Esc", words: "back to the path, nothing marked", keys: { Escape: (a) => a.escape() } },
];

const TABLE = new Map(KEYS.flatMap((key) => Object.entries(key.keys)));

/** Listens on the document; keys that a control needs for itself stay with it. */
export function startKeys(actions: Actions): void {
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
        const target = event.target as HTMLElement;
        const writes = target.matches("input:not([type=checkbox]):not([type=range]), select, textarea");
        const presses = target.matches("button, summary, [role=button], [role=tab], a, input[type=checkbox]") && event.key === " ";
        const slides = target.matches("input[type=range], [role=tab]") && /^(Arrow|Home|End)/.test(event.key);
        if ((writes && event.key !== "Escape") || presses || slides) return;
        const name = event.shiftKey && event.key.startsWith("Arrow") ? `Shift+${event.key}` : event.key.length === 1 ? event.key.toLowerCase() : event.key;
        const action = TABLE.get(name);
        if (!action) return;
        event.preventDefault();
        action(actions);
    });
}
