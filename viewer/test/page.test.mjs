// Pages of all kinds in headless Chromium: what a person sees and does.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { launch, open } from "./browser.mjs";
import { look } from "./look.mjs";
import { FROM } from "./sample_robot.mjs";
import { sample } from "./sample.mjs";
import { page as pageOf } from "./write_page.mjs";

const pictures = join(dirname(fileURLToPath(import.meta.url)), "../../target/viewer-samples");
const folder = mkdtempSync(join(tmpdir(), "foliate-viewer-"));
let browser;

function written(kind, change = () => {}) {
    const { view, binary } = sample(kind);
    change(view);
    const file = join(folder, `${kind}.html`);
    writeFileSync(file, pageOf(view, binary));
    return file;
}

before(async () => {
    mkdirSync(pictures, { recursive: true });
    browser = await launch();
});

after(async () => {
    await browser.close();
    rmSync(folder, { recursive: true });
});

for (const kind of ["path", "refused", "scene", "search", "model"]) {
    test(`a page of kind ${kind} is looked at`, async () => {
        const row = await look(browser, written(kind), pictures);
        assert.deepEqual(row.missing, ["package://arm/palm.dae"]);
    });
}

test("links stand where the path says", async () => {
    const { page } = await open(browser, written("path"));
    const box = await page.evaluate(() => (window.foliate.setTime(0), window.foliate.linkPose("box/body")));
    assert.ok(Math.hypot(box[0] - FROM[0], box[1] - FROM[1], box[2] - 0.445) < 1e-6, `${box}`);
    assert.equal(await page.evaluate(() => window.foliate.linkPose("no/such")), null);
    await page.close();
});

test("it plays in real time, and the keyboard steers it", async () => {
    const { page } = await open(browser, written("path"));
    await page.keyboard.press("Space");
    const begin = Date.now();
    await page.waitForFunction(() => window.foliate.time() > 0.8, { timeout: 8000 });
    const wall = (Date.now() - begin) / 1000;
    assert.ok(wall > 0.6, `0.8 s of the path took ${wall} s`);
    await page.keyboard.press("Space");
    assert.equal(await page.evaluate(() => window.foliate.playing()), false);
    const time = () => page.evaluate(() => window.foliate.time());
    await page.keyboard.press("Home");
    assert.equal(await time(), 0);
    await page.keyboard.press(".");
    assert.ok(Math.abs((await time()) - sample("path").view.path.segments[1].from) < 1e-9);
    await page.keyboard.press(",");
    assert.equal(await time(), 0);
    await page.keyboard.press("?");
    assert.ok(await page.$("dialog[open]"));
    await page.keyboard.press("Escape");
    assert.equal(await page.$("dialog[open]"), null);
    await page.close();
});

test("nothing is drawn while nothing changes", async () => {
    const { page } = await open(browser, written("path"));
    const frames = () => page.evaluate(() => window.foliate.stats().frames);
    await new Promise((done) => setTimeout(done, 600));
    const before = await frames();
    await new Promise((done) => setTimeout(done, 600));
    assert.equal(await frames(), before);
    await page.close();
});

test("a click on a pair of the funnel shows where it collided", async () => {
    const { page } = await open(browser, written("search"));
    await page.$$eval(".funnel details", (all) => all.forEach((one) => (one.open = true)));
    const { view } = sample("search");
    const pair = view.search.funnel.flatMap((row) => row.pairs).find((p) => p.configuration);
    await page.$$eval(".pair", (all) => all.find((one) => one.textContent.includes("box/body and room/ball")).click());
    assert.match(await page.$eval(".caption-pose", (e) => e.textContent), /box\/body and room\/ball collided, 18 mm deep/);
    const shown = await page.evaluate(() => window.foliate.configuration());
    assert.deepEqual(shown, pair.configuration);
    await page.keyboard.press("Escape");
    assert.notDeepEqual(await page.evaluate(() => window.foliate.configuration()), pair.configuration);
    await page.close();
});

test("the growth of the roadmap is replayed by its slider", async () => {
    const { page } = await open(browser, written("search"));
    const told = (step) =>
        page.$eval(
            ".growth input",
            (slider, value) => {
                slider.value = String(value);
                slider.dispatchEvent(new Event("input"));
                return document.querySelector(".roadmap > output").textContent;
            },
            step,
        );
    assert.match(await told(0), /: 1 nodes, 0 edges/);
    // Node i grows at step 5 i; all but the first three have an edge.
    assert.match(await told(50), /: 11 nodes, 8 edges/);
    assert.match(await told(1495), /: 300 nodes, 297 edges/);
    await page.close();
});

test("a model tells which of its links collide as its sliders move", async () => {
    const { page } = await open(browser, written("model"));
    assert.deepEqual(await page.evaluate(() => window.foliate.collisionsNow()), []);
    await page.$$eval(".slider", (all) => {
        const move = (name, value) => {
            const input = all.find((one) => one.textContent.includes(name)).querySelector("input");
            input.value = String(value);
            input.dispatchEvent(new Event("input"));
        };
        move("arm/shoulder", 0.3);
        move("arm/elbow", -1.2);
        move("arm/lift", 0.2);
    });
    // The fingers reach down to 0.62 + 0.06 - 0.2 - 0.1 - 0.08 = 0.3; the table reaches from 0.36 to 0.4.
    const found = await page.evaluate(() => window.foliate.collisionsNow());
    assert.deepEqual(found, [["arm/finger", "room/table"], ["arm/other_finger", "room/table"]]);
    await page.waitForFunction(() => document.querySelector(".contacts p").textContent === "2 pairs collide now:");
    await page.close();
});

test("two clicks measure", async () => {
    const { page } = await open(browser, written("scene"));
    await page.keyboard.press("m");
    for (const y of [-0.5, -0.2]) {
        const [px, py] = await page.evaluate((at) => window.foliate.project([0.5, at, 0.4]), y);
        await page.mouse.click(px, py);
    }
    const told = await page.$eval(".caption-picked", (e) => e.textContent);
    const [, distance, along] = /^(\d+) mm \(x .*, y (-?\d+) mm, z .*\)/.exec(told) ?? assert.fail(told);
    // A pixel of the picture is some millimetres of the table.
    assert.ok(Math.abs(distance - 300) < 8 && Math.abs(along - 300) < 8, told);
    await page.close();
});

test("a finding of the start or goal is shown with its number", async () => {
    const { page } = await open(browser, written("scene"));
    const findings = await page.$$eval(".finding", (all) => all.map((one) => one.textContent));
    assert.deepEqual(findings, ["At the goalbox/body and room/ball collide, 3.20 mm deep", "At the startbox lies on the table: off by 0.0123, allowed 0.0001"]);
    await page.click(".finding");
    assert.equal(await page.$eval(".label-failure", (e) => e.textContent), "3.20 mm deep");
    assert.deepEqual(await page.evaluate(() => window.foliate.configuration()), sample("scene").view.goal);
    // An object that lies in no state: a line leads to where it would have to be, 0.0123 m below and turned by 0.05 rad.
    await (await page.$$(".finding"))[1].click();
    assert.equal(await page.$eval(".label-failure", (e) => e.textContent), "12 mm, 2.9\u00b0 off");
    assert.deepEqual(await page.evaluate(() => window.foliate.configuration()), sample("scene").view.start);
    await page.close();
});

test("it works in a frame of a notebook", async () => {
    const file = join(folder, "notebook.html");
    const inner = readFileSync(written("path"), "utf8").replaceAll("&", "&amp;").replaceAll('"', "&quot;");
    writeFileSync(file, `<!doctype html><html data-ready="true"><body><iframe sandbox="allow-scripts" width="700" height="420" srcdoc="${inner}"></iframe>`);
    const { page, errors, requests } = await open(browser, file);
    const frame = await (await page.$("iframe")).contentFrame();
    await frame.waitForFunction(() => document.documentElement.dataset.ready === "true", { timeout: 10000 });
    await page.screenshot({ path: join(pictures, "notebook.png") });
    assert.deepEqual([errors, requests], [[], []]);
    await page.close();
});

test("a page of another format says so", async () => {
    const { page } = await open(browser, written("path", (view) => (view.format = "foliate.view/99")));
    assert.match(await page.$eval(".broken", (e) => e.textContent), /foliate\.view\/99/);
    await page.close();
});

test("every control has a name", async () => {
    const { page } = await open(browser, written("search"));
    const nameless = await page.$$eval("button, input, select, [role=slider], [role=button]", (all) =>
        all.filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim() || one.labels?.length)).map((one) => one.outerHTML.slice(0, 120)),
    );
    assert.deepEqual(nameless, []);
    await page.close();
});
