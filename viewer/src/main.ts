/** Reads the page's data, builds the page, draws the first frame, says that it is ready. */
import { h } from "./app/dom";
import { hooks, keepErrors } from "./app/hooks";
import { startKeys, type Actions } from "./app/keys";
import { Model, type SwitchName } from "./app/model";
import { startPlayer } from "./app/player";
import { chooseTheme, startTheme, theme } from "./app/theme";
import { readPage } from "./data/read";
import { buildPage, type Page } from "./panes/layout";
import { VIEWS, type ViewName } from "./scene/views";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

function actions(model: Model, page: Page): Actions {
    const toggle = (name: string): void => {
        const names: SwitchName[] = name === "ghosts" ? ["start", "goal"] : name === "grippers" ? ["grippers", "handles"] : [name as SwitchName];
        const on = !names.every((one) => model.switches[one].value);
        for (const one of names) model.toggle(one, on);
    };
    return {
        play: () => model.play(),
        seek: (by) => {
            model.playing.set(false);
            model.setTime(model.time.value + by);
        },
        step: (by) => model.step(by),
        end: (at) => model.setTime(at === "start" ? 0 : model.duration),
        faster: (by) => {
            const at = SPEEDS.indexOf(model.speed.value) + by;
            model.speed.set(SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)]!);
        },
        toggle,
        view: (index) => page.scene.views.look(Object.keys(VIEWS)[index] as ViewName),
        fit: () => page.scene.views.look(null),
        measure: () => model.measuring.set(!model.measuring.value),
        theme: () => chooseTheme(theme.value === "dark" ? "light" : "dark"),
        help: () => page.help.showModal(),
        escape: () => model.clear(),
    };
}

/** A page that cannot be shown says why, in place of a blank. */
function failed(root: HTMLElement, error: unknown): void {
    root.className = "";
    root.replaceChildren(h("div", { class: "broken", role: "alert" }, h("h1", {}, "This page cannot be shown"), h("p", {}, String(error instanceof Error ? error.message : error))));
}

async function main(root: HTMLElement): Promise<void> {
    const begun = performance.now();
    keepErrors();
    startTheme();
    const { view, arrays } = await readPage();
    const model = new Model(view, arrays);
    const page = buildPage(root, model);
    startPlayer(model);
    startKeys(actions(model, page));
    page.scene.stage.draw();
    Object.assign(window, { foliate: hooks(model, page, begun) });
    document.documentElement.dataset["ready"] = "true";
}

const root = document.getElementById("foliate")!;
main(root).catch((error: unknown) => {
    console.error(error);
    failed(root, error);
});
