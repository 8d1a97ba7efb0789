// A page in headless Chromium that may load nothing: what it asks for, and what goes wrong, is kept.
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

// By require, so that NODE_PATH can name the folder of the package.
const puppeteer = createRequire(import.meta.url)("puppeteer-core");

export function chromium() {
    const places = [process.env.FOLIATE_CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    return places.find((place) => place && existsSync(place));
}

export function launch() {
    const executablePath = chromium();
    if (!executablePath) throw new Error("there is no chromium; FOLIATE_CHROMIUM names one");
    return puppeteer.launch({ executablePath, args: ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--hide-scrollbars"] });
}

/** Opens a file; answers when the page has drawn its first frame. */
export async function open(browser, file, { width = 1280, height = 800, scheme = "light", touch = false, wait = 30000 } = {}) {
    // A context of its own: what one page keeps, such as the theme, is not seen by the next.
    const page = await (await browser.createBrowserContext()).newPage();
    const url = pathToFileURL(file).href;
    const [requests, errors] = [[], []];
    await page.setViewport({ width, height, hasTouch: touch, isMobile: touch });
    await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
    await page.setRequestInterception(true);
    page.on("request", (request) => {
        const allowed = request.url() === url || request.url().startsWith("data:") || request.url().startsWith("blob:");
        if (!allowed) requests.push(request.url());
        void (allowed ? request.continue() : request.abort());
    });
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(url);
    await page.waitForFunction(() => document.documentElement.dataset.ready === "true" || document.querySelector(".broken"), { timeout: wait });
    return { page, requests, errors };
}
