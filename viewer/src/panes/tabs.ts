/** Tabs: one pane at a time. */
import { h } from "../app/dom";

export interface Tab {
    name: string;
    label: string;
    /** A number beside the label, e.g. of problems. */
    badge?: number;
    content: HTMLElement;
}

export class Tabs {
    readonly root: HTMLElement;
    private readonly buttons: HTMLButtonElement[];
    private readonly panes: HTMLElement[];
    private selected = "";

    constructor(private readonly tabs: Tab[]) {
        this.buttons = tabs.map((tab, i) => {
            const badge = tab.badge ? h("span", { class: "badge" }, String(tab.badge)) : null;
            return h("button", { type: "button", role: "tab", id: `tab-${tab.name}`, "aria-controls": `pane-${tab.name}`, onclick: () => this.select(tab.name), onkeydown: (event: KeyboardEvent) => this.arrow(event, i) }, tab.label, badge);
        });
        this.panes = tabs.map((tab) => h("div", { class: `pane pane-${tab.name}`, role: "tabpanel", id: `pane-${tab.name}`, "aria-labelledby": `tab-${tab.name}`, tabindex: -1 }, tab.content));
        this.root = h("div", { class: "tabs" }, h("div", { class: "tab-list", role: "tablist" }, ...this.buttons), ...this.panes);
        const first = tabs[0];
        if (first) this.select(first.name);
    }

    select(name: string): void {
        if (!this.tabs.some((tab) => tab.name === name)) return;
        this.selected = name;
        this.tabs.forEach((tab, i) => {
            const on = tab.name === name;
            this.buttons[i]!.setAttribute("aria-selected", String(on));
            this.buttons[i]!.tabIndex = on ? 0 : -1;
            this.panes[i]!.hidden = !on;
        });
    }

    /** A tab whose pane stands elsewhere has no button here. */
    hide(name: string, hidden: boolean): void {
        const i = this.tabs.findIndex((tab) => tab.name === name);
        if (i < 0) return;
        this.buttons[i]!.hidden = hidden;
        const other = this.tabs.find((tab) => tab.name !== name);
        if (hidden && this.selected === name && other) this.select(other.name);
    }

    pane(name: string): HTMLElement | undefined {
        return this.panes[this.tabs.findIndex((tab) => tab.name === name)];
    }

    private arrow(event: KeyboardEvent, from: number): void {
        const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
        if (by === 0) return;
        event.preventDefault();
        for (let i = from + by; i >= 0 && i < this.buttons.length; i += by) {
            if (this.buttons[i]!.hidden) continue;
            this.select(this.tabs[i]!.name);
            this.buttons[i]!.focus();
            return;
        }
    }
}
