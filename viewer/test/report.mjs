// Looks at the report of a batch as a person would: node test/report.mjs FOLDER PAGE.html
// Screenshots go to FOLDER. Ends with an error where anything is wrong.
import assert from "node:assert/strict";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { launch } from "./browser.mjs";

async function open(browser, file, width) {
    const page = await browser.newPage();
    const url = pathToFileURL(file).href;
    const [requests, errors] = [[], []];
    await page.setViewport({ width, height: 900 });
    await page.setRequestInterception(true);
    page.on("request", (request) => {
        if (request.url() !== url) requests.push(request.url());
        void (request.url() === url ? request.continue() : request.abort());
    });
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(url);
    return { page, requests, errors };
}

/** Each plot as it lies on the page: its size, and the texts that leave it or lie on each other. */
const plots = (page) =>
    page.$$eval("svg", (plots) =>
        plots.map((plot) => {
            const frame = plot.getBoundingClientRect();
            const texts = [...plot.querySelectorAll("text")].map((text) => ({ text: text.textContent.trim(), box: text.getBoundingClientRect() }));
            const outside = texts.filter(({ box }) => box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1);
            const apart = (a, b) => a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 || b.bottom <= a.top + 1;
            const over = texts.filter(({ box }, i) => texts.slice(0, i).some((other) => !apart(box, other.box)));
            const names = (list) => list.map(({ text }) => text);
            return { label: plot.getAttribute("aria-label"), width: frame.width, height: frame.height, marks: plot.children.length, outside: names(outside), over: names(over) };
        }),
    );

const [folder, file] = process.argv.slice(2);
const browser = await launch();
try {
    for (const [name, width] of [["wide", 1280], ["narrow", 420]]) {
        const { page, requests, errors } = await open(browser, file, width);
        assert.deepEqual(requests, [], "the page asks for nothing");
        assert.deepEqual(errors, []);
        const scroll = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(scroll <= width, `the page is ${scroll} px wide on a screen of ${width}`);
        const found = await plots(page);
        assert.ok(found.length > 0);
        for (const plot of found) {
            assert.ok(plot.width > 0.7 * Math.min(width, 960) && plot.height > 50, `${plot.label}: ${plot.width} x ${plot.height}`);
            assert.ok(plot.marks > 10, `${plot.label}: ${plot.marks} marks`);
            assert.deepEqual(plot.outside, [], `${plot.label}: texts beyond its edge`);
            assert.deepEqual(plot.over, [], `${plot.label}: texts on each other`);
        }
        await page.screenshot({ path: join(folder, `report-${name}.png`), fullPage: true });
        await page.close();
    }
} finally {
    await browser.close();
}
