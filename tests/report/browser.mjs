// Opens a page of `goingrate report` in headless Chromium and looks at what it draws.
// Arguments: CHROMIUM PAGE FOLDER-FOR-PICTURES [brief: figures, zoom and words alone]. Speaks the DevTools protocol over a pipe (messages
// end with a zero byte), so that node needs no packages.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [chromium, page, folder, extent] = process.argv.slice(2);
const profile = mkdtempSync(join(tmpdir(), "goingrate-browser-"));
const browser = spawn(chromium, ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
  `--user-data-dir=${profile}`, "--remote-debugging-pipe"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });

let faults = 0;
function check(holds, what) {
  console.log(`${holds ? "ok   " : "FAULT"} ${what}`);
  if (!holds) ++faults;
}

// ---- the protocol

const waiting = new Map();
const complaints = [];
let last = 0, session, unread = Buffer.alloc(0);

function hear({ id, method, params, result, error }) {
  if (id) {
    const { resolve: done, reject } = waiting.get(id);
    waiting.delete(id);
    if (error) reject(new Error(error.message));
    else done(result);
  }
  if (method === "Runtime.exceptionThrown") complaints.push(params.exceptionDetails.exception?.description);
  if (method === "Runtime.consoleAPICalled" && ["error", "warning"].includes(params.type))
    complaints.push(params.args.map((a) => a.value ?? a.description).join(" "));
  if (method === "Log.entryAdded" && params.entry.level === "error") complaints.push(params.entry.text);
}

browser.stdio[4].on("data", (bytes) => {
  unread = Buffer.concat([unread, bytes]);
  for (let end = unread.indexOf(0); end >= 0; end = unread.indexOf(0)) {
    hear(JSON.parse(unread.subarray(0, end)));
    unread = unread.subarray(end + 1);
  }
});

function send(method, params = {}) {
  const id = ++last;
  browser.stdio[3].write(JSON.stringify({ id, method, params, sessionId: session }) + "\0");
  return new Promise((done, reject) => waiting.set(id, { resolve: done, reject }));
}

async function value(expression) {
  const answer = await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
  if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description);
  return answer.result.value;
}

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

async function setWidth(width) {
  await send("Emulation.setDeviceMetricsOverride", { width, height: 900, deviceScaleFactor: 1, mobile: width < 600 });
  await pause(1200); // plotly answers a change of width after a while
}

async function picture(name, width) {
  await setWidth(width);
  const top = 0, bottom = await value("document.documentElement.scrollHeight");
  let bytes = 0, number = 0;
  for (let y = top; y < bottom; y += 1500) { // in sheets that a viewer shows without shrinking them
    const clip = { x: 0, y, width, height: Math.min(1500, bottom - y), scale: 1 };
    const { data } = await send("Page.captureScreenshot", { captureBeyondViewport: true, clip });
    writeFileSync(join(folder, `${name}-${++number}.png`), Buffer.from(data, "base64"));
    bytes += data.length;
  }
  check(bytes > 100000, `pictures ${width} px wide: ${name}-1.png to -${number}.png`);
}

async function load(scripts) {
  await send("Emulation.setScriptExecutionDisabled", { value: !scripts });
  const began = Date.now();
  await send("Page.navigate", { url: pathToFileURL(resolve(page)).href });
  const ready = scripts ? "document.documentElement.dataset.figures" : "document.readyState === 'complete' && document.querySelector('.still')";
  for (let i = 0; i < 1200; ++i) {
    if (await value(`Boolean(${ready})`).catch(() => false)) return Date.now() - began;
    await pause(50);
  }
  throw new Error(`the page is not ready after a minute; ${complaints.join("; ")}`);
}

// ---- what must hold

// Values drawn per unit of the time axis in the first plot, of those that are seen.
const density = `(() => { const gd = document.querySelector(".live"), r = gd._fullLayout.xaxis.range;
  const inside = (t) => Array.from(t.x).filter((x) => x !== null && x >= r[0] && x <= r[1]).length;
  return gd.data.reduce((n, t) => n + inside(t), 0) / (r[1] - r[0]); })()`;
const shown = (selector) => `[...document.querySelectorAll("${selector}")].filter((e) => e.offsetHeight > 0).length`;

async function checkFigures() {
  const places = await value(`document.querySelectorAll(".live").length`);
  check(places > 0 && await value(`[...document.querySelectorAll(".live")].every((e) => e.querySelector(".main-svg") && e.data.length)`),
    `all ${places} plots are drawn`);
  check(await value(shown(".still")) === 0, "the still figures make way");
  check(await value(`[...document.querySelectorAll(".live")].every((e) => e.tabIndex === 0 && e.ariaLabel)`),
    "every plot can be reached by the keyboard and has a name");
  check(await value(`[...document.querySelectorAll("figure")].every((e) => e.querySelector("figcaption").textContent)`),
    "every figure has a caption");
  check(await value(`[...document.querySelectorAll("figure h3")].every((e) => e.parentElement.querySelector(".live") || getComputedStyle(e).display === "inline")`),
    "a heading stands over a figure or leads a caption");
  check(await value(`[...document.querySelectorAll(".live")].every((e) => e.data.every((t) => t.x.length < 6000))`),
    "no trace has more than a few values per pixel");
}

async function checkZoom() {
  const before = await value(density);
  const cut = await value(`(async () => { const gd = document.querySelector(".live"), [a, b] = gd._fullLayout.xaxis.range;
    const to = [a + 0.45 * (b - a), a + 0.47 * (b - a)]; const t = performance.now();
    await Plotly.relayout(gd, { "xaxis.range": to }); await new Promise((r) => setTimeout(r, 300));
    return to; })()`);
  const after = await value(density);
  const long = await value(`JSON.parse(document.getElementById("figure-data").textContent).arrays.some((a) => a.count > 5000)`);
  check(long ? after > 1.5 * before : after > 0, `a zoom draws finer: ${before.toPrecision(3)} values a unit, then ${after.toPrecision(3)}`);
  const ranges = await value(`[...document.querySelectorAll(".live")].map((e) => e._fullLayout.xaxis).filter((x) => x.title.text.startsWith("time")).map((x) => x.range)`);
  check(ranges.length > 0 && ranges.every((r) => Math.abs(r[0] - cut[0]) < 1e-6 * Math.abs(cut[0])), "figures that share the time axis zoom together");
  await picture("zoomed", 1000);
  await value(`document.querySelector(".live").focus()`);
  await send("Input.dispatchKeyEvent", { type: "keyDown", key: "0", text: "0" });
  await pause(500);
  check(Math.abs(await value(density) / before - 1) < 0.05, "the key 0 shows all again");
}

// What is cut off or scrolls sideways, in words; figures may do as they like inside their place, but
// their texts must stay in it.
const misfits = `(() => {
  const found = [], room = document.documentElement.clientWidth, name = (e) => e.tagName + "." + e.className + " " + e.textContent.trim().slice(0, 40);
  const hidden = (e) => e.closest("thead") && getComputedStyle(e.closest("thead")).position === "absolute";
  if (document.documentElement.scrollWidth > room) found.push("the page scrolls sideways");
  for (const e of document.body.querySelectorAll("*")) {
    if (e.closest("#js-plotly-tester")) continue; // where plotly measures texts
    const box = e.getBoundingClientRect(), place = e.closest(".live, .still");
    if (!box.width || !box.height || hidden(e) || e.tagName === "SCRIPT") continue;
    if (!place && (box.right > room + 0.5 || box.left < -0.5)) found.push(name(e) + " reaches beyond the page");
    if (!place && e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).display !== "inline") found.push(name(e) + " scrolls sideways");
    if (place && e.tagName === "text" && getComputedStyle(e).visibility !== "hidden") {
      const outer = place.getBoundingClientRect();
      if (box.right > outer.right + 1 || box.left < outer.left - 1 || box.bottom > outer.bottom + 1 || box.top < outer.top - 1)
        found.push("the text '" + e.textContent + "' leaves its figure");
    }
  }
  return [...new Set(found)].slice(0, 5);
})()`;

async function checkFit(what) {
  const found = await value(misfits);
  check(found.length === 0, `${what}: nothing is cut and nothing scrolls sideways ${found.join("; ")}`);
}

async function checkLooks() {
  const paper = () => value(`document.querySelector(".live")._fullLayout.paper_bgcolor`);
  const papers = {};
  for (const scheme of ["light", "dark"]) {
    await send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
    for (const width of [390, 768, 1280]) {
      await picture(`${scheme}-${width}`, width);
      await checkFit(`${scheme}, ${width} px`);
    }
    papers[scheme] = await paper();
  }
  check(papers.light !== papers.dark, "the dark has colours of its own");
  await send("Emulation.setEmulatedMedia", { features: [] });
  check(complaints.length === 0, `no complaint on the console ${complaints.join("; ")}`);
}

// A4 less the margins of the style sheet, in px.
async function checkPrint() {
  await send("Emulation.setEmulatedMedia", { media: "print" });
  await setWidth(673);
  check(await value(shown(".still")) > 0 && await value(shown(".live")) === 0, "on paper the figures are the still ones");
  check(await value(`[...document.querySelectorAll("figure")].every((e) =>
    getComputedStyle(e).breakInside === "avoid" && e.getBoundingClientRect().height < 1001)`), "no figure is cut in two on A4");
  await checkFit("on paper");
  await send("Emulation.setEmulatedMedia", { media: "" });
  const { data } = await send("Page.printToPDF", { preferCSSPageSize: true, printBackground: true });
  writeFileSync(join(folder, "page.pdf"), Buffer.from(data, "base64"));
  await setWidth(1000);
}

async function checkNames() {
  const { nodes } = await send("Accessibility.getFullAXTree");
  const roles = ["button", "link", "img", "image", "region", "group", "navigation", "heading"];
  const seen = nodes.filter((n) => !n.ignored && roles.includes(n.role?.value));
  const nameless = seen.filter((n) => !n.name?.value);
  check(seen.length > 20 && nameless.length === 0,
    `${seen.length} things that a screen reader announces have names ${nameless.map((n) => n.role.value).join(" ")}`);
}

const begins = { svg: "<svg", png: "\x89PNG", csv: "panel,series,time since the first beat (" };

async function checkSaving() {
  const saved = mkdtempSync(join(tmpdir(), "goingrate-saved-"));
  await send("Page.setDownloadBehavior", { behavior: "allow", downloadPath: saved });
  for (const [format, begin] of Object.entries(begins)) {
    await value(`document.querySelector("button[data-format=${format}]").focus()`);
    await send("Input.dispatchKeyEvent", { type: "keyDown", key: "Enter", code: "Enter", text: "\r", windowsVirtualKeyCode: 13 });
    await send("Input.dispatchKeyEvent", { type: "keyUp", key: "Enter", code: "Enter", windowsVirtualKeyCode: 13 });
    let file;
    for (let i = 0; i < 100 && !file; ++i) {
      await pause(100);
      file = readdirSync(saved).find((name) => name.endsWith(`.${format}`));
    }
    const text = file && existsSync(join(saved, file)) ? readFileSync(join(saved, file), "latin1") : "";
    if (format === "csv") check(/rate \(\S{0,3}s\/day\)/.test(text.slice(0, 200)), "its header and the names of its panels tell units");
    check(text.startsWith(begin) && text.length > 1000, `a figure is saved as ${format} (${text.length} bytes) by the keyboard`);
    if (file) writeFileSync(join(folder, `saved.${format}`), readFileSync(join(saved, file)));
  }
  rmSync(saved, { recursive: true });
}

async function checkWords() {
  const held = await value(`JSON.parse(document.getElementById("goingrate").textContent).summary`);
  const read = await value(`[...document.querySelectorAll(".says p")].map((p) => p.textContent)`);
  check(held.length >= 3 && held.length <= 6 && JSON.stringify(held) === JSON.stringify(read), "the page says what its JSON holds");
}

async function checkTheRest() {
  await checkNames();
  await checkSaving();
  await checkLooks();
  await checkPrint();
  await load(false);
  await setWidth(390);
  await checkFit("without scripts, 390 px");
  check(await value(shown(".still")) > 0 && await value(shown(".live")) === 0, "without scripts there are the still figures");
}

try {
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  ({ sessionId: session } = await send("Target.attachToTarget", { targetId, flatten: true }));
  for (const domain of ["Page", "Runtime", "Log", "Accessibility"]) await send(`${domain}.enable`);
  await send("Emulation.setDeviceMetricsOverride", { width: 1000, height: 900, deviceScaleFactor: 1, mobile: false });
  await send("Page.addScriptToEvaluateOnNewDocument", { source: `addEventListener("load", () => {
    window.atLoad = { live: document.querySelectorAll(".live .main-svg").length,
      still: [...document.querySelectorAll(".still")].every((e) => e.offsetHeight > 0) }; })` });
  console.log(`      drawn ${await load(true)} ms after the call`);
  check(await value("atLoad.live === 0 && atLoad.still"), "the page opens with its static figures, before plotly draws");
  await checkFigures();
  await checkZoom();
  await checkWords();
  if (extent !== "brief") await checkTheRest();
} catch (error) {
  check(false, error.message);
} finally {
  const gone = new Promise((done) => browser.once("exit", done));
  browser.kill();
  await gone;
  try {
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  } catch {
    // A helper of the browser may still write to it: what is left in the folder for temporary files is no fault.
  }
}
process.exit(faults > 0 ? 1 : 0);
