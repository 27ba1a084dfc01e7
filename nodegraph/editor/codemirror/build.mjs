// Writes codemirror.js, and the licences of the packages in it, into the folder that is named:
//   npm ci && node build.mjs .
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { build } from "esbuild";

const folder = process.argv[2];
const { metafile } = await build({
  entryPoints: ["entry.js"],
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "CodeMirror",
  target: "es2022",
  charset: "ascii",
  legalComments: "none",
  banner: { js: "/* CodeMirror 6; see LICENSES.txt */" },
  outfile: join(folder, "codemirror.js"),
  metafile: true,
});
const packages = new Set();
for (const path of Object.keys(metafile.inputs)) {
  const match = /^(.*\/node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(`./${path}`);
  if (match) packages.add(match[1]);
}
const notices = [...packages].map((path) => {
  const { name, version } = JSON.parse(readFileSync(join(path, "package.json"), "utf8"));
  return `${name} ${version}\n\n${readFileSync(join(path, "LICENSE"), "utf8").trim()}\n`;
});
writeFileSync(join(folder, "LICENSES.txt"), notices.sort().join(`\n${"-".repeat(78)}\n\n`));
