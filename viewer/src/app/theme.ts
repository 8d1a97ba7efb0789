/** Light or dark: the system's choice until a person makes one. */
import { Signal } from "./signal";

export type Theme = "light" | "dark";

const KEY = "foliate.theme";

function kept(): Theme | null {
    // Storage is refused in frames of notebooks and may be in files.
    try {
        const value = localStorage.getItem(KEY);
        return value === "light" || value === "dark" ? value : null;
    } catch {
        return null;
    }
}

const system = matchMedia("(prefers-color-scheme: dark)");
let chosen = kept();
export const theme = new Signal<Theme>(chosen ?? (system.matches ? "dark" : "light"));

export function chooseTheme(value: Theme): void {
    chosen = value;
    try {
        localStorage.setItem(KEY, value);
    } catch {
        // The choice lasts as long as the page.
    }
    theme.set(value);
}

export function startTheme(): void {
    system.addEventListener("change", () => {
        if (!chosen) theme.set(system.matches ? "dark" : "light");
    });
    theme.watch((value) => {
        document.documentElement.dataset["theme"] = value;
    });
}
