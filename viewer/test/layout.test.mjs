// The source keeps its layout: imports run one way, files stay short.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const src = join(dirname(fileURLToPath(import.meta.url)), "../src");
/** A folder imports from itself and from those before it. */
const LAYERS = ["data", "motion", "shape", "collide", "app", "scene", "panes", ""];
const MOST_LINES = 400;

const files = readdirSync(src, { recursive: true }).filter((file) => file.endsWith(".ts"));
const folderOf = (file) => (file.includes("/") ? file.split("/")[0] : "");

function importsOf(file) {
    const text = readFileSync(join(src, file), "utf8");
    const found = [...text.matchAll(/from "(\.[^"]+)"/g)].map((match) => match[1]);
    return found.map((target) => `${relative(src, join(src, dirname(file), target))}.ts`);
}

test("imports run one way between folders", () => {
    assert.ok(files.length > 30);
    const wrong = files.flatMap((file) => importsOf(file).filter((to) => LAYERS.indexOf(folderOf(to)) > LAYERS.indexOf(folderOf(file))).map((to) => `${file} imports ${to}`));
    assert.deepEqual(wrong, []);
});

test("no file imports itself by way of others", () => {
    const state = new Map();
    const visit = (file, chain) => {
        if (state.get(file) === "done") return;
        assert.ok(state.get(file) !== "open", `a circle: ${[...chain, file].join(" > ")}`);
        state.set(file, "open");
        for (const to of importsOf(file)) visit(to, [...chain, file]);
        state.set(file, "done");
    };
    for (const file of files) visit(file, []);
});

test("files are short", () => {
    const long = files.filter((file) => readFileSync(join(src, file), "utf8").split("\n").length > MOST_LINES);
    assert.deepEqual(long, []);
});
