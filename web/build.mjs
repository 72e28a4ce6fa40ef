// Puts the page together: node build.mjs LIBRARY.wasm CRATES.txt PAGE.html.gz. It writes one HTML file, compressed. The same
// sources give the same bytes.

import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { gzipSync } from "node:zlib";

const [library, crates, target] = process.argv.slice(2);
if (!target) throw new Error("expected the compiled library, the list of its crates, and the file to write");
const MOST = 3e6;

const text = (path) => readFileSync(new URL(path, import.meta.url), "utf8");
const version = /\[workspace\.package\]\s+version = "([^"]+)"/.exec(text("../Cargo.toml"))[1];

async function script(entry) {
  const { outputFiles } = await build({
    entryPoints: [new URL(entry, import.meta.url).pathname],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2022",
    legalComments: "none",
  });
  return outputFiles[0].text.trim();
}

async function style(entry) {
  const { outputFiles } = await build({ entryPoints: [new URL(entry, import.meta.url).pathname], minify: true, write: false });
  return outputFiles[0].text.trim();
}

const licences = [
  "opm: MIT or Apache-2.0, at your option.\n",
  text("../LICENSE-MIT"),
  `three.js ${JSON.parse(text("node_modules/three/package.json")).version}:\n`,
  text("node_modules/three/LICENSE"),
  "Rust crates in the compiled library, with their licences:\n",
  readFileSync(crates, "utf8"),
  "The standard library of Rust: MIT OR Apache-2.0",
].join("\n");

const packed = (content) => gzipSync(content, { level: 9 }).toString("base64");
// Nothing that is put into a script may look like the end of one.
const harmless = (content) => content.replace(/<\/(script)/gi, "<\\/$1").replace(/<!--/g, "<\\!--");
const looks = await style("src/style.css");
const main = await script("src/main.ts");
const start = harmless(await script("src/start.ts"));
const hash = (content) => `'sha256-${createHash("sha256").update(content).digest("base64")}'`;
// Whatever a mechanism file holds: the page runs its own scripts and styles alone, and asks no network for anything.
const policy = [
  "default-src 'none'",
  `script-src ${hash(start)} ${hash(main)} 'wasm-unsafe-eval'`,
  "worker-src blob:",
  `style-src ${hash(looks)}`,
  "img-src data: blob:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");
const parts = {
  POLICY: policy,
  "/*STYLE*/": looks,
  LIBRARY: packed(readFileSync(library)),
  WORKER: harmless(await script("src/worker.ts")),
  LICENCES: harmless(licences),
  SCRIPT: packed(main),
  START: start,
};
const template = text("src/index.html").replaceAll("VERSION", version);
const page = template.replace(/\/\*STYLE\*\/|\b(?:POLICY|LIBRARY|WORKER|LICENCES|SCRIPT|START)\b/g, (name) => parts[name]);
if (Buffer.byteLength(page) > MOST) throw new Error(`the page has ${Buffer.byteLength(page)} bytes, expected at most ${MOST}`);

mkdirSync(dirname(target), { recursive: true });
const small = gzipSync(page, { level: 9 });
// The header of a gzip file names the system that wrote it; this is the number for unknown.
small[9] = 255;
writeFileSync(target, small);
console.log(`${target}: ${Buffer.byteLength(page)} bytes, ${small.length} compressed`);
