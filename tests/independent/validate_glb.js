// Validates GLB files with the Khronos glTF validator (npm: gltf-validator), and prints what it finds.
//
//     NODE_PATH=.../node_modules node validate_glb.js FILE.glb...
//
// Exit code 0 where no file has an error, else 1.
const fs = require("fs");
const validator = require("gltf-validator");

async function main() {
  let errors = 0;
  for (const file of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 100 });
    const { numErrors, numWarnings, messages } = report.issues;
    errors += numErrors;
    const { animationCount, drawCallCount, totalTriangleCount } = report.info;
    console.log(JSON.stringify({ file, numErrors, numWarnings, animationCount, drawCallCount, totalTriangleCount }));
    for (const message of messages.filter((m) => m.severity <= 1)) console.log(JSON.stringify(message));
  }
  process.exit(errors === 0 ? 0 : 1);
}

main();
