/** Pan and zoom of an SVG drawing by its view box: drag, wheel, two fingers, buttons. */
import { h, iconButton } from "../app/dom";

export interface PanZoom {
    /** Shows the whole drawing. */
    fit(): void;
    /** Moves the view so that a rectangle is inside. */
    reveal(x: number, y: number, w: number, h: number): void;
    buttons: HTMLElement;
}

export function panZoom(drawing: SVGSVGElement, width: number, height: number, zoomed: (unitsPerPixel: number) => void): PanZoom {
    let box = { x: 0, y: 0, w: width, h: height };
    const scale = (): number => Math.max(box.w / Math.max(drawing.clientWidth, 1), box.h / Math.max(drawing.clientHeight, 1));
    const apply = (): void => {
        drawing.setAttribute("viewBox", `${box.x} ${box.y} ${box.w} ${box.h}`);
        zoomed(scale());
    };
    /** The view box in the shape of the element, so that a pixel is as many units everywhere. */
    const square = (): void => {
        const { clientWidth, clientHeight } = drawing;
        if (clientWidth === 0 || clientHeight === 0) return;
        const s = scale();
        box = { x: box.x + (box.w - s * clientWidth) / 2, y: box.y + (box.h - s * clientHeight) / 2, w: s * clientWidth, h: s * clientHeight };
    };
    const zoom = (factor: number, px: number, py: number): void => {
        square();
        const s = scale();
        const next = Math.min(Math.max(s * factor, 0.15), (6 * Math.max(width, height)) / Math.max(drawing.clientWidth, 1));
        const [x, y] = [box.x + px * s, box.y + py * s];
        box = { x: x - px * next, y: y - py * next, w: (box.w * next) / s, h: (box.h * next) / s };
        apply();
    };
    const fit = (): void => {
        const margin = 12;
        box = { x: -margin, y: -margin, w: width + 2 * margin, h: height + 2 * margin };
        square();
        apply();
    };
    drawing.addEventListener(
        "wheel",
        (event) => {
            event.preventDefault();
            const at = drawing.getBoundingClientRect();
            zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), event.clientX - at.left, event.clientY - at.top);
        },
        { passive: false },
    );
    drag(drawing, zoom, (dx, dy) => {
        const s = scale();
        box.x -= dx * s;
        box.y -= dy * s;
        apply();
    });
    let fitted = false;
    new ResizeObserver(() => {
        if (drawing.clientWidth === 0) return;
        if (fitted) {
            square();
            apply();
        } else fit();
        fitted = true;
    }).observe(drawing);
    const middle = (factor: number) => (): void => zoom(factor, drawing.clientWidth / 2, drawing.clientHeight / 2);
    const buttons = h(
        "div",
        { class: "pan-zoom" },
        iconButton("plus", "Zoom in", middle(0.75)),
        iconButton("minus", "Zoom out", middle(1.33)),
        iconButton("fit", "Show the whole graph", fit),
    );
    const reveal = (x: number, y: number, w: number, hh: number): void => {
        if (x >= box.x && y >= box.y && x + w <= box.x + box.w && y + hh <= box.y + box.h) return;
        box = { ...box, x: x + w / 2 - box.w / 2, y: y + hh / 2 - box.h / 2 };
        apply();
    };
    return { fit, reveal, buttons };
}

/** One pointer moves; two zoom about their middle. */
function drag(element: SVGSVGElement, zoom: (factor: number, x: number, y: number) => void, move: (dx: number, dy: number) => void): void {
    const pointers = new Map<number, { x: number; y: number }>();
    const spread = (): number => {
        const [a, b] = [...pointers.values()];
        return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
    };
    let travelled = 0;
    element.addEventListener("pointerdown", (event) => {
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        travelled = 0;
    });
    element.addEventListener("pointermove", (event) => {
        const old = pointers.get(event.pointerId);
        if (!old) return;
        const before = spread();
        const [dx, dy] = [event.clientX - old.x, event.clientY - old.y];
        travelled += Math.hypot(dx, dy);
        // Capturing at once would take the click from the states.
        if (travelled > 4 && !element.hasPointerCapture(event.pointerId)) element.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (pointers.size === 2) {
            const [a, b] = [...pointers.values()];
            const at = element.getBoundingClientRect();
            if (before > 0) zoom(before / spread(), (a!.x + b!.x) / 2 - at.left, (a!.y + b!.y) / 2 - at.top);
        } else move(dx, dy);
    });
    for (const end of ["pointerup", "pointercancel", "pointerleave"] as const) {
        element.addEventListener(end, (event) => pointers.delete(event.pointerId));
    }
}
