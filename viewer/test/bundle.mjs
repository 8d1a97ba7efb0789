// Loads a module of the viewer's TypeScript source into node.
import { build } from "esbuild";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const viewer = join(dirname(fileURLToPath(import.meta.url)), "..");

/** `source` is TypeScript that exports from "./src/…". */
export async function load(source) {
    const result = await build({
        stdin: { contents: source, resolveDir: viewer, loader: "ts" },
        absWorkingDir: viewer,
        bundle: true,
        write: false,
        format: "esm",
        platform: "node",
    });
    const folder = mkdtempSync(join(viewer, "node_modules/.foliate-"));
    try {
        const file = join(folder, "bundle.mjs");
        writeFileSync(file, result.outputFiles[0].text);
        return await import(pathToFileURL(file).href);
    } finally {
        rmSync(folder, { recursive: true });
    }
}
