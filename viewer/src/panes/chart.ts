/** One curve over time, drawn once on a canvas; a cursor moves over it. */
import { h } from "../app/dom";
import { theme } from "../app/theme";

export interface Series {
    name: string;
    times: ArrayLike<number>;
    value: (k: number) => number;
    duration: number;
    /** Dashed lines; outside of them is shaded. */
    lower: number | null;
    upper: number | null;
    unit: string;
    colour: "position" | "velocity" | "clearance";
}

export interface Chart {
    root: HTMLElement;
    /** Moves the cursor and the number. */
    at(time: number, k: number): void;
}

const HEIGHT = 54;

export function chart(series: Series, jump: (time: number) => void): Chart {
    const canvas = h("canvas", { height: HEIGHT });
    const cursor = h("div", { class: "chart-cursor" });
    const value = h("output", { class: "chart-value" });
    const plot = h("div", { class: "chart-plot" }, canvas, cursor);
    const root = h("div", { class: "chart" }, h("div", { class: "chart-head" }, h("span", {}, series.name), value), plot);
    const draw = (): void => {
        if (plot.clientWidth > 0) paint(canvas, plot.clientWidth, series);
    };
    new ResizeObserver(draw).observe(plot);
    theme.watch(draw);
    plot.addEventListener("pointerdown", (event) => {
        const box = plot.getBoundingClientRect();
        jump(((event.clientX - box.left) / box.width) * series.duration);
    });
    const at = (time: number, k: number): void => {
        cursor.style.left = `${(100 * time) / series.duration}%`;
        value.textContent = `${series.value(k).toFixed(3)} ${series.unit}`;
    };
    return { root, at };
}

/** The range of values, widened by the limits where those are near. */
export function rangeOf(series: Series): [number, number] {
    let [low, high] = [Infinity, -Infinity];
    for (let k = 0; k < series.times.length; k++) {
        const v = series.value(k);
        if (v < low) low = v;
        if (v > high) high = v;
    }
    if (!Number.isFinite(low)) return [0, 1];
    const span = Math.max(high - low, 1e-3);
    if (series.lower !== null && series.lower > low - 1.5 * span) low = Math.min(low, series.lower);
    if (series.upper !== null && series.upper < high + 1.5 * span) high = Math.max(high, series.upper);
    const margin = Math.max(0.08 * (high - low), 5e-4);
    return [low - margin, high + margin];
}

function paint(canvas: HTMLCanvasElement, width: number, series: Series): void {
    const ratio = Math.min(devicePixelRatio, 2);
    canvas.width = width * ratio;
    canvas.height = HEIGHT * ratio;
    canvas.style.width = `${width}px`;
    const context = canvas.getContext("2d")!;
    const style = getComputedStyle(document.documentElement);
    context.scale(ratio, ratio);
    const [low, high] = rangeOf(series);
    const x = (t: number): number => (t / series.duration) * width;
    const y = (v: number): number => HEIGHT - ((v - low) / (high - low)) * HEIGHT;
    context.clearRect(0, 0, width, HEIGHT);
    context.strokeStyle = style.getPropertyValue("--limit");
    context.fillStyle = style.getPropertyValue("--limit-area");
    context.setLineDash([4, 3]);
    for (const [limit, edge] of [[series.lower, HEIGHT], [series.upper, 0]] as const) {
        if (limit === null || limit < low || limit > high) continue;
        context.fillRect(0, Math.min(y(limit), edge), width, Math.abs(edge - y(limit)));
        context.beginPath();
        context.moveTo(0, y(limit));
        context.lineTo(width, y(limit));
        context.stroke();
    }
    context.setLineDash([]);
    context.strokeStyle = style.getPropertyValue(`--curve-${series.colour}`);
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    context.beginPath();
    for (let k = 0; k < series.times.length; k++) context.lineTo(x(series.times[k]!), y(series.value(k)));
    context.stroke();
}
