// assemble.mjs PROJECT FOLDER: puts FOLDER/goingrate.html together from the page's sources in apps/web/page and
// the command in FOLDER/wasm. Needs only node.
import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const [project, folder] = process.argv.slice(2);
const sources = join(project, "apps/web/page");
const read = (path) => readFileSync(path, "utf8");
const source = (name) => read(join(sources, name));
const megabyte = 1e6, most = 8 * megabyte;

// ---- one script from the page's modules, each after the modules that it imports

function moduleOrder(name, order = []) {
  if (order.includes(name)) return order;
  for (const [, imported] of source(name).matchAll(/^import .* from "\.\/(.*)";$/gm)) moduleOrder(imported, order);
  order.push(name);
  return order;
}

const variableOf = (module) => `from_${module.replace(/\W/g, "_")}`;

// A module becomes a function that is called at once: its imports are taken from those before it, and it returns
// what it exports.
function wrapped(module) {
  const text = source(module).replace(/^import (\{.*\}) from "\.\/(.*)";$/gm,
    (_, names, imported) => `const ${names} = ${variableOf(imported)};`);
  const exported = [...text.matchAll(/^export (?:async )?(?:function|const|class) (\w+)/gm)].map((match) => match[1]);
  return `const ${variableOf(module)} = (() => {\n${text.replace(/^export /gm, "")}return { ${exported.join(", ")} };\n})();\n`;
}

const joined = (name) => moduleOrder(name).map(wrapped).join("\n");

// ---- what is embedded

const packed = (bytes) => gzipSync(bytes, { level: 9 }).toString("base64");

function filesOf(path, ending) {
  return readdirSync(join(project, path)).filter((name) => name.endsWith(ending) && name !== "README.md")
    .sort().map((name) => `${path}/${name}`);
}

// The licence of each part of the page, from Debian's copyright files.
function licences() {
  const installed = ["libeigen3-dev", "libfmt-dev", "libboost-dev", "nlohmann-json3-dev", "libcli11-dev",
    "libtomlplusplus-dev", "libfast-float-dev", "emscripten"].map((name) => [name, `/usr/share/doc/${name}/copyright`]);
  const compiled = ["ceres-solver", "fftw3", "libsndfile", "libzip", "zlib"]
    .map((name) => [name, join(folder, "libraries/sources", name, "debian/copyright")]);
  const plotly = read(join(folder, "wasm/src/plotly-basic.min.js")).match(/^\/\*[^]*?\*\//)?.[0] ?? "";
  const parts = [["goingrate", join(project, "LICENSE")], ...compiled, ...installed]
    .filter(([, path]) => existsSync(path)).map(([name, path]) => `==== ${name}\n\n${read(path).trim()}`);
  return [...parts, `==== plotly.js\n\n${plotly}`].join("\n\n");
}

function contents() {
  const paths = [...filesOf("data/logs", ".csv"), ...filesOf("data/course", ".md"), ...filesOf("data/course", ".csv")];
  const files = Object.fromEntries(paths.map((path) => [path, read(join(project, path))]));
  return JSON.stringify({ ...files, "licences.txt": licences() });
}

// ---- the scripts that may run: this page's and those of the report's page, each by its hash

const hashOf = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

function policyFor(main) {
  const report = ["wasm/src/plotly-basic.min.js"].map((name) => join(folder, name))
    .concat(["page_series.js", "page.js"].map((name) => join(project, "src/report", name)));
  const scripts = [main, ...report.map(read)].map(hashOf);
  // blob: is for the worker and the report, which this page makes itself; the inline styles are for plotly.js and
  // the report.
  return ["default-src 'none'", `script-src ${scripts.join(" ")} 'wasm-unsafe-eval'`, "worker-src blob:",
    "frame-src blob:", "style-src 'unsafe-inline'", "img-src data: blob:", "base-uri 'none'", "form-action 'none'"].join("; ");
}

function checked(text, what) {
  if (/<\/script|<!--/i.test(text)) throw new Error(`${what} contains text that would end a script`);
  return text;
}

const main = `"use strict";\n${joined("main.js")}`;
const parts = {
  main: checked(main, "the page's script"),
  worker: checked(`${read(join(folder, "wasm/goingrate.js"))}\n${source("worker.js")}`, "the worker"),
  command: packed(readFileSync(join(folder, "wasm/goingrate.wasm"))),
  contents: packed(contents()),
  style: source("style.css"),
  policy: policyFor(main),
  version: read(join(project, "CMakeLists.txt")).match(/project\(goingrate VERSION ([0-9.]+)/)[1],
  limit: "some ten million", // beats: eight million take 2.6 of the 4 GB; a million take 31 s
};
const page = source("page.html").replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
const target = join(folder, "goingrate.html");
writeFileSync(target, page);
const bytes = statSync(target).size;
if (bytes > most) throw new Error(`${target} has ${bytes} bytes: more than ${most}`);
console.log(`${target}: ${(bytes / megabyte).toFixed(2)} MB`);
