// A log chosen by the page's first file input gives the same report as the native command; the settings of the form
// are used; a run can be cancelled.
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fitDifference } from "./compare.mjs";
import { check, pause } from "./driver.mjs";
import { writeLogs } from "./logs.mjs";

const shown = (id) => `!document.getElementById("${id}").hidden`;
const idle = `document.getElementById("log-progress").hidden`;
const link = (name) => `[...document.querySelectorAll("#downloads a")].find((a) => a.download === "${name}")`;
export const done = `(${idle} && (${shown("log-result")} || ${shown("log-failure")}))`;

// Notes every stage that is shown, and counts how often the page's own clock ticks meanwhile.
const watch = `(() => { window.seen = []; window.ticks = 0;
  new MutationObserver(() => seen.push(document.querySelector("#log-progress .stage").textContent))
    .observe(document.querySelector("#log-progress .stage"), { childList: true, characterData: true, subtree: true });
  setInterval(() => { if (!document.getElementById("log-progress").hidden) ++ticks; }, 20); })()`;

export async function choose(browser, paths) {
  await browser.choose("input[type=file]", paths);
  await browser.until(`!${idle}`, "the run begins");
}

async function reportDraws(browser) {
  for (let i = 0; i < 600; ++i, await pause(100)) {
    for (const session of [...browser.frames.values()]) {
      const drawn = await browser.value(`document.documentElement.dataset.figures && document.querySelectorAll(".live .main-svg").length`, session).catch(() => 0);
      if (drawn > 0) return { drawn, session };
    }
  }
  return { drawn: 0 };
}

export async function report(browser, { goingrate, source, folder }) {
  const log = join(source, "data/logs/jump.csv");
  execFileSync(goingrate, ["report", log, "-o", join(folder, "native.html"), "--json", join(folder, "native.json")], { stdio: "ignore" });
  const native = JSON.parse(readFileSync(join(folder, "native.json"), "utf8"));
  await browser.value(watch);
  const began = Date.now();
  await choose(browser, [log]);
  await browser.until(done, "the report");
  console.log(`      the report of jump.csv after ${((Date.now() - began) / 1000).toFixed(1)} s`);
  check(await browser.value(shown("log-result")), `there is a report ${await browser.value("document.getElementById('log-failure').textContent")}`);
  const stages = await browser.value("[...new Set(seen.map((s) => s.replace(/ \\.\\.\\. \\d+ s$/, '')))]");
  check(stages.some((s) => /^\d of \d: /.test(s)) && stages.some((s) => s.startsWith("reading")), `stages are told: ${stages.join(" | ")}`);
  check(await browser.value("ticks") > 20, `the page stays alive: its clock ticked ${await browser.value("ticks")} times`);
  const { drawn, session } = await reportDraws(browser);
  check(drawn > 3, `${drawn} figures are drawn by plotly.js in the report's own frame`);
  const said = session && await browser.value(`JSON.parse(document.getElementById("goingrate").textContent).summary`, session);
  check(JSON.stringify(said) === JSON.stringify(native.summary), "the report says what the native one says");
  const json = JSON.parse((await browser.savedBy(link("report.json"))).bytes);
  const { largest, faults } = fitDifference(native.fit, json.fit);
  check(faults.length === 0, `its fit is that of the command to ${largest.toFixed(5)} sigma ${faults.join("; ")}`);
  check(JSON.stringify(json.numbers) === JSON.stringify(native.numbers), "its table of numbers is that of the command, to the last digit");
  const page = (await browser.savedBy(link("report.html"))).bytes.toString();
  check(page.trimEnd().endsWith("</html>") && /plotly\.js \(basic/.test(page), `the page that is saved is whole: ${page.length} bytes, with plotly.js`);
  for (const name of ["summary.txt", "diary.csv", "rates.csv", "parameters.tex", "rate.svg"])
    check((await browser.savedBy(link(name))).bytes.length > 0, `${name} can be saved`);
  const all = await browser.savedBy(`document.getElementById("save-all")`);
  writeFileSync(join(folder, "all.zip"), all.bytes);
  const listed = execFileSync("unzip", ["-t", join(folder, "all.zip")], { encoding: "utf8" });
  check(/No errors detected/.test(listed) && /report\.html/.test(listed), "all of it can be saved as a ZIP that unzip finds whole");
  for (const command of ["rate", "fit", "spectrum", "stability"]) {
    await browser.click(`#more-${command}`);
    await browser.until(`${idle} && document.querySelector("#downloads details:last-child summary").textContent.match(/^(${{ rate: "Beats", fit: "Fit", spectrum: "Spectrum", stability: "Stability" }[command]})/)`, command);
  }
  check((await browser.savedBy(link("fit.par"))).bytes.toString().startsWith("# goingrate par 1"), "other commands write their files too");
  await browser.picture(join(folder, "report.png"), 1000);
}

/** A log in two files, its weather and its diary, dropped together. */
export async function dropped(browser, { goingrate, source, folder }) {
  const place = join(folder, "dropped");
  mkdirSync(place, { recursive: true });
  writeLogs(place, source, goingrate);
  const files = ["first.txt", "second.txt", "weather.csv", "diary.csv"].map((name) => [name, readFileSync(join(place, name), "utf8")]);
  await browser.value(`(() => { const dropped = new DataTransfer();
    for (const [name, text] of ${JSON.stringify(files)}) dropped.items.add(new File([text], name));
    document.documentElement.dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true, cancelable: true })); })()`);
  await browser.until(`!${idle}`, "the run begins");
  await browser.until(done, "the report");
  const text = await browser.value(`document.getElementById("summary").textContent`);
  check(/rate per K of temperature/.test(text), "what is dropped is read: the weather");
  const json = JSON.parse((await browser.savedBy(link("report.json"))).bytes);
  check(json.rate.crossings === 1200 && json.kept_diary, `both logs, ${json.rate.crossings} beats, and the diary`);
}

export async function settings(browser, { source }) {
  const summary = `document.getElementById("summary").textContent`;
  await choose(browser, [join(source, "data/course/2-ring-down.csv")]);
  await browser.until(done, "the report");
  const before = await browser.value(summary);
  check(/2/.test(await browser.value(`document.getElementById("set-nominal-period").placeholder`)), "the form shows the nominal period that was found");
  await browser.value(`(() => { const field = document.getElementById("set-nominal-period"); field.value = "2.001";
    field.dispatchEvent(new Event("change", { bubbles: true })); })()`);
  await browser.until(`!${idle}`, "the run begins");
  await browser.until(done, "the next report");
  const after = await browser.value(summary);
  check(after !== before && /against 2\.001 s/.test(after), "the report follows the form");
  await browser.value(`(() => { const field = document.getElementById("set-nominal-period"); field.value = "x";
    field.dispatchEvent(new Event("change", { bubbles: true })); })()`);
  await browser.until(`${idle} && ${shown("log-failure")}`, "a message");
  check(/nominal-period/.test(await browser.value(`document.getElementById("log-failure").textContent`)), "what the form says wrongly is named");
}

export async function cancels(browser, { goingrate, source, folder }) {
  const long = join(folder, "long.csv");
  if (!existsSync(long)) execFileSync(goingrate, ["simulate", join(source, "data/scenarios/noisy-drive.toml"), "--set", "run.periods=60000", "-o", long], { stdio: "ignore" });
  await choose(browser, [long]);
  await browser.until(`/^[2-9] of/.test(document.querySelector("#log-progress .stage").textContent)`, "a stage");
  await browser.value(`document.querySelector("#log-progress button").focus()`);
  await browser.press("Enter");
  await browser.until(idle, "the end of the run");
  check(await browser.value(`document.getElementById("log-result").hidden && /Cancelled/.test(document.getElementById("log-failure").textContent)`),
    "Cancel by the keyboard ends the run and says so");
  const workers = async () => (await browser.send("Target.getTargets", {}, undefined)).targetInfos.filter((target) => target.type === "worker");
  const patience_s = 10; // a browser ends a worker that is busy after two seconds
  for (let waited = 0; waited < patience_s && (await workers()).length > 0; ++waited) await new Promise((go) => setTimeout(go, 1000));
  check((await workers()).length === 0, "no worker goes on");
  await choose(browser, [join(source, "data/course/2-ring-down.csv")]);
  await browser.click("#forget");
  await browser.until(idle, "the end of the run");
  await choose(browser, [join(source, "data/course/2-ring-down.csv")]);
  await browser.until(done, "the report");
  check(await browser.value(shown("log-result")), "after that the page works as before");
}

/** A million lines. */
export async function largest(browser, { goingrate, source, folder }) {
  const log = join(folder, "million.csv");
  if (!existsSync(log)) execFileSync(goingrate, ["simulate", join(source, "data/scenarios/noisy-drive.toml"), "--set", "run.periods=1000000", "-o", log], { stdio: "ignore" });
  const began = Date.now();
  await choose(browser, [log]);
  await browser.until(done, "the report");
  check(await browser.value(shown("log-result")), `a million lines make a report, in ${((Date.now() - began) / 1000).toFixed(0)} s ` +
    await browser.value(`document.getElementById("log-failure").textContent`));
}
