// Makes the pictures of README and docs from what the program answers: node pictures.mjs FOLIATE
// FOLIATE is the program, built with its default features; the published models of Baxter are installed (foliate models --install).
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, open } from "./test/browser.mjs";
import { documentOf } from "./test/look.mjs";

const sharp = createRequire(import.meta.url)("sharp");
const figures = join(dirname(fileURLToPath(import.meta.url)), "../docs/figures");

/** The seed of every search: the same program makes the same pictures. */
const SEED = "1";
/** Frames of the animation; they are spread over the path evenly and shown in its own time. */
const FRAMES = 40;
/** Milliseconds for which the last frame stays, so that a reader sees where the animation begins again. */
const LAST_FRAME_MS = 1200;
/** The least page that has the graph beside the scene leaves this much for the scene. */
const SCENE_WIDTH = 640;
const DEMO_PAGE = { width: 980, height: 580 };
const BAXTER_PAGE = { width: 1280, height: 800 };
/** Bytes above which a picture makes README slow to load. */
const MOST = { "demo.gif": 600_000, "baxter-case4.png": 250_000, "funnel.png": 250_000, "demo-graph.svg": 100_000 };

/** Opens a page whose requests and errors would spoil the picture. */
async function opened(browser, file, size) {
    const { page, requests, errors } = await open(browser, file, { ...size, wait: 60_000 });
    if (requests.length > 0 || errors.length > 0) throw new Error(`${file}: ${[...requests, ...errors].join("; ")}`);
    return page;
}

/** The page at a moment, drawn wholly. */
async function at(page, time, clip) {
    await page.evaluate((t) => (window.foliate.setTime(t), window.foliate.frame()), time);
    return Buffer.from(await page.screenshot({ clip }));
}

/** Scene and timeline of a page from the beginning to the end of its path. */
async function animation(browser, file) {
    const { duration } = documentOf(file).path;
    const page = await opened(browser, file, DEMO_PAGE);
    // Buttons in a picture do nothing. Words of one line and of two take the same room, so that the scene stays where it is.
    await page.addStyleTag({ content: ".toolbar, .transport > :is(button, select) { display: none !important } .now { min-height: 38px }" });
    const top = await page.$eval(".viewport", (e) => e.getBoundingClientRect().top);
    const clip = { x: 0, y: top, width: SCENE_WIDTH, height: DEMO_PAGE.height - top };
    const frames = [];
    for (let i = 0; i < FRAMES; i++) frames.push(await at(page, (duration * i) / (FRAMES - 1), clip));
    await page.close();
    const delay = Array(FRAMES).fill(Math.round((1000 * duration) / (FRAMES - 1)));
    delay[FRAMES - 1] = LAST_FRAME_MS;
    return sharp(frames, { join: { animated: true } }).gif({ colours: 96, dither: 0, effort: 10, interFrameMaxError: 2, delay, loop: 0 }).toBuffer();
}

/** The middle of the longest segment in a state where most hands hold something. */
function busiest(view) {
    const hands = (segment) => view.graph.states[segment.state]?.lines?.length ?? 0;
    const length = (segment) => segment.to - segment.from;
    const best = view.path.segments.reduce((a, b) => (hands(b) - hands(a) || length(b) - length(a)) > 0 ? b : a);
    return (best.from + best.to) / 2;
}

/** A whole page at the moment when most happens. */
async function still(browser, file) {
    const page = await opened(browser, file, BAXTER_PAGE);
    const picture = await at(page, busiest(documentOf(file)));
    await page.close();
    return sharp(picture).png({ palette: true, colours: 128, dither: 0, effort: 10, compressionLevel: 9 }).toBuffer();
}

/** The page of a recorded search: its roadmap, the funnel of the transition that was tried most, and where its most frequent pair collided. */
async function funnel(browser, file) {
    const page = await opened(browser, file, BAXTER_PAGE);
    await page.$$eval("[role=tab]", (tabs) => tabs.find((tab) => tab.textContent.startsWith("Search")).click());
    await page.$$eval(".funnel details", (rows) => (rows.find((row) => row.querySelector(".pair")).open = true));
    await page.$eval(".funnel details[open] .pair", (pair) => pair.click());
    await page.$eval(".funnel details[open]", (pairs) => pairs.parentElement.scrollIntoView({ block: "start" }));
    await page.evaluate(() => window.foliate.frame());
    const picture = Buffer.from(await page.screenshot());
    await page.close();
    return sharp(picture).png({ palette: true, colours: 128, dither: 0, effort: 10, compressionLevel: 9 }).toBuffer();
}

function keep(name, bytes) {
    if (bytes.length > MOST[name]) throw new Error(`${name} has ${bytes.length} bytes, ${MOST[name]} are allowed`);
    writeFileSync(join(figures, name), bytes);
    console.log(`docs/figures/${name}: ${Math.round(bytes.length / 1000)} kB`);
}

async function main(program) {
    statSync(program);
    const folder = mkdtempSync(join(tmpdir(), "foliate-pictures-"));
    const foliate = (...line) => execFileSync(program, line, { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
    const file = (name) => join(folder, name);
    let browser;
    try {
        foliate("graph", "demo", "--svg", "-o", file("demo-graph.svg"));
        foliate("demo", "--seed", SEED, "--view", file("demo.html"));
        foliate("solve", "baxter-case4", "--seed", SEED, "--out", file("baxter-case4.json"));
        // The page of a path file says that the check has proved it.
        foliate("view", file("baxter-case4.json"), "-o", file("baxter-case4.html"));
        foliate("solve", "baxter-case4", "--first", "--seed", SEED, "--record", file("baxter-case4.search"));
        foliate("view", file("baxter-case4.search"), "-o", file("search.html"));
        browser = await launch();
        keep("demo-graph.svg", readFileSync(file("demo-graph.svg")));
        keep("demo.gif", await animation(browser, file("demo.html")));
        keep("baxter-case4.png", await still(browser, file("baxter-case4.html")));
        keep("funnel.png", await funnel(browser, file("search.html")));
    } finally {
        await browser?.close();
        rmSync(folder, { recursive: true });
    }
}

if (process.argv.length !== 3) {
    console.error("node pictures.mjs FOLIATE");
    process.exit(2);
}
await main(resolve(process.argv[2]));
