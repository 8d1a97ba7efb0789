// Looks at pages as a person would, and says what is wrong: node test/look.mjs FOLDER PAGE.html...
// Screenshots go to FOLDER, a table of sizes and times to FOLDER/pages.json. Ends with 1 where anything is wrong.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { pathToFileURL } from "node:url";
import { gunzipSync } from "node:zlib";
import { launch, open } from "./browser.mjs";

/** Milliseconds from the beginning of the navigation to the first frame. */
export const READY_MS = Number(process.env.FOLIATE_PAGE_READY_MS ?? 3000);

/** The document inside a page. */
export function documentOf(file) {
    const packed = /id="foliate-json">([^<]*)</.exec(readFileSync(file, "utf8"))[1];
    return JSON.parse(gunzipSync(Buffer.from(packed, "base64")).toString());
}

/** A number that differs where pictures differ, and how many colours there are; counted in the page, for pictures are megabytes. */
const picture = (page) =>
    page.evaluate(() => {
        const bytes = window.foliate.pixels();
        const colours = new Set();
        let hash = 2166136261;
        for (let i = 0; i < bytes.length; i += 4) {
            const colour = bytes[i] * 65536 + bytes[i + 1] * 256 + bytes[i + 2];
            hash = Math.imul(hash ^ colour, 16777619);
            if (i % 388 === 0) colours.add(colour);
        }
        return { hash, colours: colours.size };
    });

/** More than a few colours, so not a blank canvas. */
async function assertDrawn(page) {
    const { colours } = await picture(page);
    assert.ok(colours > 8, `the scene is nearly blank: ${colours} colours`);
}

async function assertMoves(page, view) {
    const pictures = new Set();
    for (const part of [0, 0.27, 0.5, 0.73, 0.95]) {
        await page.evaluate((t) => window.foliate.setTime(t), part * view.path.duration);
        pictures.add((await picture(page)).hash);
    }
    assert.equal(pictures.size, 5, "five times of the path give five pictures");
}

/** At the middle of each segment the graph lights its state and its transition, and the timeline names it. */
async function assertGraphFollows(page, view) {
    const middles = view.path.segments.map((segment) => (segment.from + segment.to) / 2);
    const lit = await page.evaluate((times) => {
        const ids = (kind) => [...document.querySelectorAll(`.${kind}.active`)].map((e) => e.getAttribute(`data-${kind}`));
        return times.map((t) => {
            window.foliate.setTime(t);
            return { states: ids("state"), transitions: ids("transition"), words: document.querySelector(".now-words").textContent };
        });
    }, middles);
    view.path.segments.forEach((segment, i) => {
        const state = view.graph.states[segment.state ?? -1];
        assert.deepEqual(lit[i].states, state ? [String(state.id)] : [], `the state lit at ${middles[i]}`);
        const transition = view.graph.transitions[segment.transition ?? -1];
        assert.deepEqual(lit[i].transitions, transition ? [String(transition.id)] : [], `the transition lit at ${middles[i]}`);
        assert.equal(lit[i].words, segment.words);
    });
}

/** A click on the box of a state goes to its next visit. */
async function assertStatesJump(page, view) {
    const { segments } = view.path;
    const visited = [...new Set(segments.map((s) => s.state))].filter((state) => view.graph.states[state ?? -1]);
    assert.ok(visited.length > 0, "the graph shows a state of the path");
    const ids = visited.map((state) => view.graph.states[state].id);
    const reached = await page.evaluate((clicked) => {
        return clicked.map((id) => {
            window.foliate.setTime(0);
            window.foliate.clickState(id);
            return [window.foliate.time(), window.foliate.activeState()];
        });
    }, ids);
    visited.forEach((state, i) => {
        const expected = segments.find((s) => s.state === state && s.from > 0) ?? segments.find((s) => s.state === state);
        assert.ok(Math.abs(reached[i][0] - expected.from) < 1e-6, `state ${ids[i]}: at ${reached[i][0]}, not ${expected.from}`);
        assert.equal(reached[i][1], ids[i]);
    });
    // And once with the mouse: nothing lies over the box.
    const shown = segments.filter((s) => visited.includes(s.state));
    const { state, from } = shown[Math.floor(shown.length / 2)];
    await page.evaluate((t) => window.foliate.setTime(t), Math.max(from - 1e-3, 0));
    await page.click(`[data-state="${view.graph.states[state].id}"] rect`);
    assert.equal(await page.evaluate(() => window.foliate.activeState()), view.graph.states[state].id);
}

/** No pane is wider than the screen, and what can be clicked is on it. */
async function assertFits(page, width) {
    const names = await page.$$eval("[role=tab]:not([hidden])", (tabs) => tabs.map((tab) => tab.id.replace("tab-", "")));
    for (const name of names) {
        const wide = await page.evaluate((pane) => {
            window.foliate.selectPane(pane);
            const shown = document.querySelector(`#pane-${pane}`);
            return { page: document.documentElement.scrollWidth, pane: shown.scrollWidth - shown.clientWidth };
        }, name);
        assert.ok(wide.page <= width, `the pane ${name} makes the page ${wide.page} px wide`);
        assert.ok(wide.pane <= 0, `the pane ${name} is ${wide.pane} px wider than the screen`);
    }
    const outside = await page.$$eval(".header button, .transport button, .toolbar button, .transport select", (buttons) =>
        buttons.filter((b) => b.getBoundingClientRect().right > innerWidth || b.getBoundingClientRect().left < 0).map((b) => b.getAttribute("aria-label")),
    );
    assert.deepEqual(outside, [], "buttons off the screen");
}

async function brightness(page) {
    const text = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const [r, g, b] = text.match(/\d+/g).map(Number);
    return (r + g + b) / 3;
}

/** The figures of the quickest of three openings, if the first is late: other programs may have held the processor. */
async function readiness(browser, file, first) {
    let best = await first.evaluate(() => window.foliate.stats());
    for (let again = 0; again < 2 && best.readyMs >= READY_MS; again++) {
        const { page } = await open(browser, file);
        const stats = await page.evaluate(() => window.foliate.stats());
        if (stats.readyMs < best.readyMs) best = stats;
        await page.close();
    }
    return best;
}

export async function look(browser, file, folder) {
    const view = documentOf(file);
    const name = basename(file, ".html");
    const shot = (page, kind) => page.screenshot({ path: join(folder, `${name}-${kind}.png`) });
    const wide = await open(browser, file);
    const stats = await readiness(browser, file, wide.page);
    const missing = await wide.page.evaluate(() => window.foliate.missing());
    await assertDrawn(wide.page);
    if (view.path) {
        await assertMoves(wide.page, view);
        if (view.graph) {
            await assertGraphFollows(wide.page, view);
            await assertStatesJump(wide.page, view);
        }
        await wide.page.evaluate((t) => window.foliate.setTime(t), 0.5 * view.path.duration);
    }
    await shot(wide.page, "light");
    await wide.page.evaluate(() => window.foliate.setTheme("dark"));
    assert.ok((await brightness(wide.page)) < 64, "the dark theme is dark");
    await wide.page.evaluate(() => window.foliate.toggle("collision", true));
    await assertDrawn(wide.page);
    await shot(wide.page, "collision-dark");
    const phone = await open(browser, file, { width: 360, height: 740, touch: true });
    assert.ok((await brightness(phone.page)) > 192, "the system's light theme is light");
    await assertDrawn(phone.page);
    await shot(phone.page, "phone");
    await assertFits(phone.page, 360);
    for (const { page, requests, errors } of [wide, phone]) {
        assert.deepEqual(requests, [], "the page asks for nothing");
        assert.deepEqual([...errors, ...(await page.evaluate(() => window.foliate.hiddenErrors()))], [], "no errors");
        await page.close();
    }
    const row = { name, kilobytes: Math.round(statSync(file).size / 1000), readyMs: stats.readyMs, readMs: stats.readMs, buildMs: stats.buildMs, drawMs: stats.drawMs, triangles: stats.triangles, drawCalls: stats.drawCalls, missing };
    assert.ok(row.readyMs < READY_MS, `${name} is ready after ${row.readyMs} ms; ${READY_MS} are allowed`);
    return row;
}

async function main([folder, ...files]) {
    mkdirSync(folder, { recursive: true });
    const browser = await launch();
    const rows = [];
    let wrong = 0;
    for (const file of files) {
        try {
            const row = await look(browser, file, folder);
            rows.push(row);
            console.log(`${row.name}: ${row.kilobytes} kB, ready in ${row.readyMs} ms, ${row.triangles} triangles, missing: ${row.missing.length}`);
        } catch (error) {
            wrong += 1;
            console.error(`${basename(file)}: ${error.message}`);
        }
    }
    await browser.close();
    writeFileSync(join(folder, "pages.json"), `${JSON.stringify(rows, null, 1)}\n`);
    return wrong === 0 ? 0 : 1;
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) process.exit(await main(process.argv.slice(2)));
