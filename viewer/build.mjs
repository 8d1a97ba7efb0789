// Builds dist/viewer.js and dist/viewer.css. With --check it only proves that the files in dist are the build of the source.
import { build } from "esbuild";
import { readFileSync, mkdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));

/** The licence of what is bundled stands at the head of the bundle, and so in each page. */
function licences() {
    const three = JSON.parse(readFileSync(join(here, "node_modules/three/package.json"), "utf8"));
    const text = readFileSync(join(here, "node_modules/three/LICENSE"), "utf8").trim();
    return `/*!\nViewer of Foliate, MIT OR Apache-2.0.\nContains three.js ${three.version} under this licence:\n\n${text}\n*/`;
}

async function bundle(entry, banner) {
    const result = await build({
        absWorkingDir: here,
        entryPoints: [entry],
        bundle: true,
        minify: true,
        write: false,
        format: "esm",
        target: ["chrome103", "firefox113", "safari16.4"],
        // A page is one file of any encoding that a mail program may guess: ASCII only.
        charset: "ascii",
        legalComments: "none",
        banner,
    });
    return result.outputFiles[0].text;
}

/** A script inside a page ends at the first of these, and the template has places of its own. */
function assertEmbeddable(name, text) {
    for (const word of ["</script", "<!--", "</style", "@@TITLE@@", "@@STYLE@@", "@@JSON@@", "@@BINARY@@", "@@SCRIPT@@"]) {
        if (text.toLowerCase().includes(word.toLowerCase())) throw new Error(`${name} contains ${word}: a page cannot embed it`);
    }
}

const outputs = {
    "viewer.js": await bundle("src/main.ts", { js: licences() }),
    "viewer.css": await bundle("src/style/viewer.css", {}),
};
let stale = 0;
for (const [name, text] of Object.entries(outputs)) {
    assertEmbeddable(name, text);
    const file = join(here, "dist", name);
    if (process.argv.includes("--check")) {
        let old = "";
        try {
            old = readFileSync(file, "utf8");
        } catch {}
        if (old !== text) {
            console.error(`dist/${name} is not the build of the source: npm run build`);
            stale += 1;
        }
    } else {
        mkdirSync(dirname(file), { recursive: true });
        writeFileSync(file, text);
        console.log(`dist/${name}: ${Math.round(text.length / 1000)} kB`);
    }
}
process.exit(stale ? 1 : 0);
