// Logs of every format that goingrate reads, written into a folder: a seconds pendulum whose drive changes once.
// Each is {name, files, words}: files to read and options beside them.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

// A linear congruential generator (Numerical Recipes' constants) and the sum of twelve: near enough to normal.
function normal(seed) {
  let state = seed;
  const uniform = () => (state = (1664525 * state + 1013904223) % 4294967296) / 4294967296;
  return () => Array.from({ length: 12 }, uniform).reduce((a, b) => a + b) - 6;
}

const two = (n) => String(n).padStart(2, "0");

function dateText(seconds, digits) {
  const whole = Math.floor(seconds), date = new Date(1000 * whole);
  return `${date.getUTCFullYear()}-${two(date.getUTCMonth() + 1)}-${two(date.getUTCDate())} ` +
    `${two(date.getUTCHours())}:${two(date.getUTCMinutes())}:${two(date.getUTCSeconds())}` +
    (seconds - whole).toFixed(digits).slice(1);
}

/** A clock's ticks as samples of sound: clicks that ring at 3 and 4 kHz, in noise. */
export function ticking(seconds, period, rate, noise) {
  const samples = Float32Array.from({ length: seconds * rate }, () => 0.01 * noise());
  for (let beat = 0; beat * period / 2 < seconds - 0.1; ++beat) {
    const from = Math.round((0.05 + beat * period / 2 + (beat % 2) * 0.003) * rate), pitch = beat % 2 ? 4000 : 3000;
    for (let i = 0; i < 0.02 * rate; ++i)
      samples[from + i] += 0.5 * Math.exp(-i / (0.004 * rate)) * Math.sin((2 * Math.PI * pitch * i) / rate);
  }
  return samples;
}

export function wav(samples, rate) {
  const data = Buffer.alloc(2 * samples.length), head = Buffer.alloc(44);
  samples.forEach((sample, i) => data.writeInt16LE(Math.max(-32768, Math.min(32767, Math.round(32767 * sample))), 2 * i));
  head.write("RIFF", 0);
  head.writeUInt32LE(36 + data.length, 4);
  head.write("WAVEfmt ", 8);
  [[16, 4], [1, 2], [1, 2], [rate, 4], [2 * rate, 4], [2, 2], [16, 2]].reduce((at, [value, size]) => head.writeUIntLE(value, at, size), 16);
  head.write("data", 36);
  head.writeUInt32LE(data.length, 40);
  return Buffer.concat([head, data]);
}

function textLogs(folder, times, amplitudes, noise) {
  const write = (name, lines) => { writeFileSync(join(folder, name), `${lines.join("\n")}\n`); return [name]; };
  const start = 1361605080, periods = times.slice(1).map((t, i) => t - times[i]);
  const error = (t, n) => 2 * n - t; // s, positive: fast
  const sway = times.slice(0, 400).flatMap((t) => Array.from({ length: 50 }, (_, i) => t + 0.04 * i));
  const angle = (t) => 0.1 * Math.exp(-t / 2000) * Math.sin(Math.PI * t) + 1e-5 * noise();
  const cycles = (s) => Math.round(16e6 * s);
  return [
    { name: "unix", files: write("unix.txt", times.map((t) => (start + t).toFixed(7))) },
    { name: "dates", files: write("dates.txt", times.map((t) => dateText(start + t, 6))) },
    { name: "mjd", files: write("mjd.txt", times.map((t) => (56345 + t / 86400).toFixed(11))) },
    { name: "counter", files: write("counter.txt", times.map((t) => String(Math.round(1e6 * t)))) },
    { name: "milliseconds", files: write("ms.txt", times.map((t) => (1e3 * t).toFixed(3))), words: ["--unit=ms"] },
    { name: "periods", files: write("periods.txt", periods.map((p) => p.toFixed(7))) },
    { name: "clock-error", files: write("error.txt", times.map((t, n) =>
      `${start + 2 * n} ${error(t, n).toFixed(6)} ${(1e3 * amplitudes[n]).toFixed(4)}`)) },
    { name: "frequency", files: write("frequency.txt", periods.map((p) => (2 / p - 1).toExponential(9))),
      words: ["--format=frequency", "--tau0=2"] },
    { name: "ticc-interval", files: write("interval.txt", times.map((t, n) => `${error(t, n).toFixed(12)} TI(A->B)`)), words: ["--tau0=2"] },
    { name: "table", files: write("table.csv", ["count,time,amplitude_mrad,temperature_c", ...times.map((t, n) =>
      `${n},${(start + t).toFixed(6)},${(1e3 * amplitudes[n]).toFixed(4)},${(20 + Math.sin(n / 300)).toFixed(2)}`)]) },
    { name: "phyphox", files: write("angle.csv", ['"Time (s)";"Angle (rad)"', ...sway.map((t) =>
      `${t.toExponential(8)};${angle(t).toExponential(6)}`.replaceAll(".", ","))]) },
    { name: "tracker", files: write("xy.txt", ["mass_A", "t\tx\ty", ...sway.map((t) => {
      const phi = 3 * angle(t);
      return `${t.toFixed(5)}\t${Math.sin(phi).toFixed(6)}\t${(-Math.cos(phi)).toFixed(6)}`;
    })]) },
    { name: "ticktock", files: write("gate.csv", ["tick,tick_block,tock,tock_block", ...periods.map((p) =>
      [p / 2 - 0.018, 0.02, p / 2 - 0.022, 0.02].map(cycles).join(","))]) },
    { name: "labx", files: write("cassy.labx", ['<?xml version="1.0" encoding="utf-8"?>\n<cassylab version="1.8">',
      `<channels count="1"><channel><quantity>Zeit</quantity><symbol>t</symbol><unit>s</unit><values count="${times.length}">`,
      ...times.map((t) => `<value>${t.toFixed(6)}</value>`), "</values></channel></channels></cassylab>"]) },
  ];
}

// Weather every ten minutes and a diary, beside a log in two files.
function joined(folder, times) {
  const start = 1361605080, half = times.length / 2;
  writeFileSync(join(folder, "first.txt"), `${times.slice(0, half).map((t) => dateText(start + t, 6)).join("\n")}\n`);
  writeFileSync(join(folder, "second.txt"), `${times.slice(half).map((t) => dateText(start + t, 6)).join("\n")}\n`);
  writeFileSync(join(folder, "weather.csv"), ["time,temperature_c,pressure_mbar", ...Array.from({ length: 12 }, (_, i) =>
    `${dateText(start - 600 + 600 * i, 0)},${(20 + Math.sin(i)).toFixed(2)},${(1013 + i).toFixed(1)}`)].join("\n") + "\n");
  writeFileSync(join(folder, "diary.csv"), `time,what,value,sigma,note\n${dateText(start + 300, 0)},note,,,weight added\n`);
}

/** Writes them with the help of the native command. */
export function writeLogs(folder, source, goingrate) {
  const run = (...words) => execFileSync(goingrate, words, { cwd: folder, stdio: ["ignore", "ignore", "ignore"] });
  const copy = (path) => { const name = path.split("/").pop(); writeFileSync(join(folder, name), readFileSync(join(source, path))); return [name]; };
  run("simulate", join(source, "data/scenarios/jump.toml"), "--set", "run.periods=1200", "-o", "base.csv", "--truth", "truth.csv");
  const rows = readFileSync(join(folder, "truth.csv"), "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
  const noise = normal(7);
  const times = rows.map((row) => row[1] + 1e-5 * noise()), amplitudes = rows.map((row) => row[4] + 1e-5 * noise());
  run("rate", "base.csv", "--phase", "phase.txt", "--ticc", "ticc.txt");
  writeFileSync(join(folder, "packed.csv.gz"), gzipSync(readFileSync(join(folder, "base.csv"))));
  writeFileSync(join(folder, "ticks.wav"), wav(ticking(60, 1, 11025, noise), 11025));
  joined(folder, times);
  execFileSync("zip", ["-q", "two.zip", "first.txt", "second.txt"], { cwd: folder });
  return [
    { name: "native", files: ["base.csv"] }, ...textLogs(folder, times, amplitudes, noise),
    { name: "phase", files: ["phase.txt"], words: ["--tau0=2"] }, { name: "ticc", files: ["ticc.txt"] },
    { name: "gzip", files: ["packed.csv.gz"] }, { name: "zip", files: ["two.zip"] },
    { name: "wav", files: ["ticks.wav"] },
    { name: "several with weather and diary", files: ["first.txt", "second.txt"], weather: ["weather.csv"], diary: "diary.csv" },
    { name: "both edges", files: copy("data/course/6-your-own.csv") },
    { name: "ring-down", files: copy("data/course/2-ring-down.csv") },
  ].map((log) => ({ words: [], weather: [], ...log }));
}

/** The words of `report` for one of them. */
export const reportWords = (log) => [...log.files, ...log.weather.map((name) => `--weather=${name}`),
  ...(log.diary ? [`--diary=${log.diary}`] : []), ...log.words];
