/** Drives the time while the path plays: one callback a frame, none while it stands. */
import type { Model } from "./model";

export function startPlayer(model: Model): void {
    let scheduled = 0;
    const frame = (now: number): void => {
        scheduled = 0;
        model.advance(now);
        schedule();
    };
    const schedule = (): void => {
        if (model.playing.value && !scheduled) scheduled = requestAnimationFrame(frame);
    };
    model.playing.watch((playing) => {
        if (playing) schedule();
        else if (scheduled) {
            cancelAnimationFrame(scheduled);
            scheduled = 0;
        }
    });
}
