// replay.mjs GOINGRATE SOURCE FOLDER: a stand-in for the command compiled to WebAssembly, in FOLDER/wasm, from which
// assemble.mjs makes a page as from the real one. It gives back what the native command wrote for the logs of the
// tests, so that everything but the compiling can be tested in a minute.
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { gzipSync } from "node:zlib";
import { basename, dirname, join } from "node:path";
import { hostileLogs } from "./hostile.mjs";

const [goingrate, source, folder] = process.argv.slice(2);

function filesBelow(path, prefix = "") {
  return readdirSync(path).flatMap((name) => (statSync(join(path, name)).isDirectory()
    ? filesBelow(join(path, name), `${prefix}${name}/`)
    : [[prefix + name, readFileSync(join(path, name), "latin1")]])); // bytes, as characters up to 255
}

// As the page's worker: files in one folder, outputs below another.
function runOf(words, paths) {
  const place = mkdtempSync(join(tmpdir(), "goingrate-replay-"));
  mkdirSync(join(place, "out"));
  for (const path of paths) copyFileSync(path, join(place, basename(path)));
  const done = spawnSync(goingrate, words.map((word) => word.replace("/out/", `${place}/out/`)), { cwd: place, encoding: "latin1", env: { PATH: "/nowhere" } }); // no gnuplot
  const run = { code: done.status, out: done.stdout, err: done.stderr, files: Object.fromEntries(filesBelow(join(place, "out"))) };
  rmSync(place, { recursive: true });
  return run;
}

const reports = [["data/logs/jump.csv"], ["data/course/2-ring-down.csv"]].map((paths) => paths.map((path) => join(source, path)));
mkdirSync(join(folder, "hostile"), { recursive: true });
reports.push(...Object.values(hostileLogs(join(folder, "hostile"), source)));
const out = (...names) => names.map((name) => `/out/${name}`);
const [page, json, diary, figures, tables] = out("report.html", "report.json", "diary.csv", "figures", "tables");
const runs = {};
for (const paths of reports) {
  const logs = paths.map((path) => basename(path)).filter((name) => name !== "diary.csv");
  const kept = paths.length > logs.length ? ["--diary=diary.csv"] : [];
  runs[`report ${logs[0]}`] = runOf(["report", ...logs, "-o", page, `--json=${json}`, `--diary-out=${diary}`, `--figures=${figures}`,
    `--tables=${tables}`, ...kept], paths);
}
for (const [command, words] of Object.entries({ rate: ["-o", "/out/rate/rates.csv"], fit: ["--par=/out/fit/fit.par"],
  spectrum: ["-o", "/out/spectrum/spectrum.csv"], stability: ["-o", "/out/stability/stability.txt"] })) {
  const folders = ["rate", "fit", "spectrum", "stability"];
  runs[`${command} jump.csv`] = runOf([command, "jump.csv", ...words.map((word) => word.replace(new RegExp(`/out/(${folders.join("|")})/`), "/out/$1-"))], [reports[0][0]]);
  const files = runs[`${command} jump.csv`].files;
  runs[`${command} jump.csv`].files = Object.fromEntries(Object.entries(files).map(([name, text]) => [name.replace("-", "/"), text]));
}

// What the page's worker asks of Emscripten's program, and no more.
const program = `const packed = "${gzipSync(JSON.stringify(runs)).toString("base64")}";
async function startGoingrate(options) {
  const unpacked = new Blob([Uint8Array.from(atob(packed), (character) => character.charCodeAt(0))]).stream().pipeThrough(new DecompressionStream("gzip"));
  const runs = await new Response(unpacked).json();
  const bytesOf = (text) => Uint8Array.from(text, (character) => character.charCodeAt(0));
  let made = {}, streams;
  const FS = {
    init: (input, ...outputs) => { streams = outputs; }, mkdir() {}, chdir() {}, writeFile() {},
    readdir: (path) => [...new Set(Object.keys(made).filter((name) => ("/out/" + name).startsWith(path + "/")).map((name) => ("/out/" + name).slice(path.length + 1).split("/")[0]))],
    stat: (path) => ({ mode: !(path.slice(5) in made) }), isDir: (mode) => mode, readFile: (path) => bytesOf(made[path.slice(5)]),
  };
  const callMain = (words) => {
    const run = runs[words[0] + " " + words[1]] ?? { code: 1, out: "", err: "goingrate: this run is not replayed: " + words.join(" "), files: {} };
    for (const stage of ["reading " + words[1], "1 of 6: numbering", "2 of 6: fitting", "3 of 6: splitting", "6 of 6: asking"]) {
      options.onStage(stage, -1);
      for (const began = Date.now(); Date.now() - began < 200;); // ms: long enough to be seen
    }
    made = run.files;
    bytesOf(run.out).forEach((byte) => streams[0](byte));
    bytesOf(run.err).forEach((byte) => streams[1](byte));
    options.onExit(run.code);
  };
  options.preRun.forEach((prepare) => prepare({ FS }));
  return { FS, callMain };
}
`;
mkdirSync(join(folder, "wasm/src"), { recursive: true });
writeFileSync(join(folder, "wasm/goingrate.js"), program);
writeFileSync(join(folder, "wasm/goingrate.wasm"), Buffer.from([0, 0x61, 0x73, 0x6d, 1, 0, 0, 0])); // an empty module
copyFileSync(join(dirname(goingrate), "src/plotly-basic.min.js"), join(folder, "wasm/src/plotly-basic.min.js"));
