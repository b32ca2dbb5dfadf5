// same_numbers.mjs PAGE GOINGRATE SOURCE FOLDER [COUNT]: on logs of all formats (or the first COUNT) the page's
// command, under node, gives what the native one gives: beats, rates and deviations to the last printed digit,
// fits within 0.02 σ. Prints how long both took, on one processor.
import { spawnSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { Command, textOf } from "./command.mjs";
import { fitDifference, textDifference } from "./compare.mjs";
import { reportWords, writeLogs } from "./logs.mjs";

const [page, goingrate, source, folder, count] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const logs = writeLogs(folder, source, goingrate).slice(0, Number(count ?? Infinity));
const command = await Command.of(page);

// The native command on one processor, writing to where the page's writes.
function native(words) {
  const out = join(folder, "out");
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out);
  const began = performance.now();
  const done = spawnSync("taskset", ["-c", "0", goingrate, ...words.map((word) => word.replace("/out/", `${out}/`))],
    { cwd: folder, encoding: "utf8" });
  const read = (name) => { try { return readFileSync(join(out, name), "utf8"); } catch { return undefined; } };
  return { code: done.status, out: done.stdout, err: done.stderr, read, seconds: (performance.now() - began) / 1000 };
}

async function web(log, words) {
  const names = [...log.files, ...log.weather, ...(log.diary ? [log.diary] : [])];
  const files = names.map((name) => ({ name, bytes: new Uint8Array(readFileSync(join(folder, name))) }));
  const result = await command.run(words, files);
  return { ...result, read: (name) => textOf(result, name) };
}

const withoutPlaces = (text) => text.split("\n").filter((line) => !/^the page is|gnuplot/.test(line)).join("\n");

async function both(log, words, outputs) {
  const one = native(words), other = await web(log, words), faults = [];
  if (one.code !== other.code) faults.push(`exit ${one.code} and ${other.code}: ${other.err.slice(0, 300)}`);
  for (const name of outputs) faults.push(...textDifference(name, one.read(name), other.read(name)));
  faults.push(...textDifference(`notes of ${words[0]}`, withoutPlaces(one.err), withoutPlaces(other.err)));
  return { one, other, faults };
}

let faults = 0, slowest = 0;
for (const log of logs) {
  const reading = [...log.files, ...log.weather.map((name) => `--weather=${name}`), ...log.words];
  const rate = await both(log, ["rate", ...reading, "-o", "/out/rates.csv"], ["rates.csv"]);
  const deviation = await both(log, ["stability", ...reading, "-o", "/out/deviation.txt"], ["deviation.txt"]);
  const report = await both(log, ["report", ...reportWords(log), "-o", "/out/report.html", "--json=/out/report.json"], []);
  const found = [...rate.faults, ...deviation.faults, ...report.faults];
  let largest = 0;
  if (report.one.code === 0 && report.other.code === 0) {
    const fit = fitDifference(JSON.parse(report.one.read("report.json")).fit, JSON.parse(report.other.read("report.json")).fit);
    largest = fit.largest;
    found.push(...fit.faults);
    if (report.one.out !== report.other.out) console.log(`      the summary of ${log.name} is not the same to the last digit`);
  }
  const ratio = report.other.seconds / report.one.seconds;
  slowest = Math.max(slowest, ratio);
  console.log(`${found.length ? "FAULT" : "ok   "} ${log.name}: fits within ${largest.toFixed(5)} sigma; report in ` +
    `${report.one.seconds.toFixed(1)} s, here ${report.other.seconds.toFixed(1)} s (${ratio.toFixed(1)} times) ${found.join("; ")}`);
  faults += found.length;
}
console.log(`      ${logs.length} logs; at most ${slowest.toFixed(1)} times as long as the native command on one processor`);
process.exit(faults > 0 ? 1 : 0);
