/** Colours that people who are blind to some still tell apart. */
import type { Theme } from "./theme";

/** For states, trees, components: differ in lightness as well as hue; no red, which means failure. */
const GROUPS: Record<Theme, string[]> = {
    light: ["#3f72af", "#d9a21b", "#2a8c5a", "#a8487f", "#4fb3d9", "#e07b39", "#7a6bb5", "#8a9a2b", "#7f8c99", "#b98a6a"],
    dark: ["#6f9fdc", "#e3b84a", "#4fb382", "#cf7fae", "#7fd0ee", "#f09a62", "#a497dd", "#b4c455", "#9aa7b4", "#cfa98c"],
};

export function groupColour(group: number, theme: Theme): string {
    const colours = GROUPS[theme];
    return colours[((group % colours.length) + colours.length) % colours.length]!;
}

export const FAILURE = "#d1242f";

/** Objects and robots whose model names no colour. */
const PARTS = {
    robot: ["#aeb8c4", "#8fa3ba", "#c3bba9"],
    object: ["#3f88c5", "#e0a030", "#3a9d74", "#b6588f", "#59b8d8", "#dd7f4a", "#8878c3"],
    environment: ["#c9c5bc", "#b9bcb6"],
};

export function partColour(kind: "robot" | "object" | "environment", index: number): string {
    const colours = PARTS[kind];
    return colours[index % colours.length]!;
}

/** From brown (never succeeds) over grey to blue (always): 0..1. */
export function rateColour(rate: number, theme: Theme): string {
    const stops = theme === "light" ? [[166, 84, 16], [143, 148, 155], [31, 98, 168]] : [[224, 140, 66], [139, 147, 158], [106, 168, 236]];
    const at = Math.min(Math.max(rate, 0), 1) * 2;
    const [a, b] = at < 1 ? [stops[0]!, stops[1]!] : [stops[1]!, stops[2]!];
    const s = at < 1 ? at : at - 1;
    return `rgb(${a.map((c, i) => Math.round(c + s * (b[i]! - c))).join(" ")})`;
}
