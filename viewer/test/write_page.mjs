// Writes a page from a document and its binary part, as the program does: the template's places are filled in order.
// On the command line: node test/write_page.mjs [KIND] OUT.html writes a sample.
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";
import { sample } from "./sample.mjs";

const viewer = join(dirname(fileURLToPath(import.meta.url)), "..");
const read = (name) => readFileSync(join(viewer, name), "utf8");
const escape = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
const pack = (bytes) => gzipSync(bytes).toString("base64");

export function page(view, binary) {
    const filling = {
        TITLE: escape(view.title),
        STYLE: read("dist/viewer.css"),
        JSON: pack(Buffer.from(JSON.stringify(view))),
        BINARY: pack(binary),
        SCRIPT: read("dist/viewer.js"),
    };
    return read("page.html")
        .split(/@@(TITLE|STYLE|JSON|BINARY|SCRIPT)@@/)
        .map((piece, i) => (i % 2 ? filling[piece] : piece))
        .join("");
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
    const [kind, out] = process.argv.length > 3 ? process.argv.slice(2) : ["path", process.argv[2] ?? "sample.html"];
    const { view, binary } = sample(kind);
    writeFileSync(out, page(view, binary));
    console.log(out);
}
