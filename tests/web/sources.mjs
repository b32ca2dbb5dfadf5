// The other sources of logs: the simulator, the worksheets, the microphone.
import { join } from "node:path";
import { check, pause } from "./driver.mjs";
import { done } from "./reports.mjs";

const idle = `document.getElementById("simulator-progress").hidden`;
const set = (key, value) => `(() => { const e = document.getElementById("slider-${key}"); e.value = ${value}; e.dispatchEvent(new Event("input")); })()`;

export async function simulator(browser, { folder }) {
  await browser.value(`location.hash = "#simulator"`);
  await browser.value(set("periods", 800));
  await browser.value(set("phi0", 150));
  await browser.value(`document.getElementById("has-event").click()`);
  const scenario = await browser.value(`document.getElementById("scenario").textContent`);
  check(/periods = 800/.test(scenario) && /\[\[event\]\]/.test(scenario), "the scenario follows the sliders");
  await browser.click("#simulate");
  await browser.until(`!${idle}`, "the run begins");
  await browser.until(`${idle} && document.querySelector("#fit-table tbody tr")`, "the fit");
  const rows = await browser.value(`[...document.querySelectorAll("#fit-table tbody tr")].map((tr) => [...tr.children].map((td) => td.textContent))`);
  const off = rows.map((row) => row[3]).filter(Boolean).map((text) => Math.abs(parseFloat(text.replace("−", "-"))));
  // Five sigma: a dozen numbers of one log stay within it but once in 10^5.
  check(off.length >= 4 && off.every((d) => d < 5), `${rows.length} numbers stand beside what was put in, at most ${Math.max(...off)} σ away`);
  const maps = await browser.value(`[...document.querySelectorAll("#maps img")].map((img) => img.complete && img.naturalWidth > 0 && img.alt.length > 40)`);
  check(maps.length === 2 && maps.every(Boolean), "the map shows the clock's place before and after the change");
  await browser.picture(join(folder, "simulator.png"), 1000);
  await browser.click("#use-simulated");
  await browser.until(done, "the report");
  check(await browser.value(`location.hash === "#logs" && !document.getElementById("log-result").hidden`), "its log goes into the report");
}

export async function worksheets(browser, { folder }) {
  await browser.value(`location.hash = "#worksheets"`);
  await browser.until(`document.querySelectorAll("#sheets button").length === 6`, "six sheets");
  const found = await browser.value(`[...document.querySelectorAll("#sheets button")].map((button) => { button.click();
    const sheet = document.getElementById("sheet"); return { title: button.textContent, text: sheet.textContent, formulas: sheet.querySelectorAll("math").length,
      links: sheet.querySelectorAll("a[download]").length, tables: sheet.querySelectorAll("pre").length,
      raw: [...sheet.querySelectorAll("p, li, h3, h4, mtext")].filter((e) => /\\$|\\\\[a-z]|\\*\\*|undefined/.test([...e.childNodes].filter((n) => n.nodeType === 3).map((n) => n.data).join(""))).map((e) => e.textContent.slice(0, 60)) }; })`);
  for (const sheet of found)
    check(sheet.text.length > 1500 && sheet.links === 2 && sheet.raw.length === 0, `worksheet '${sheet.title}' with its log; ${sheet.formulas} formulas ${sheet.raw.join(" | ")}`);
  check(found.filter((sheet) => sheet.formulas > 5).length >= 4, "formulas are set");
  await browser.picture(join(folder, "worksheet.png"), 1000);
  await browser.value(`document.querySelectorAll("#sheets button")[1].click()`);
  await browser.value(`document.querySelector("#sheet button").click()`);
  await browser.until(done, "the report");
  check(await browser.value(`!document.getElementById("log-result").hidden`), "a sheet's log goes into the report");
}

/** Of the libraries that are compiled into the page, and of the others. */
export async function licences(browser) {
  await browser.value(`location.hash = "#about"`);
  const terms = await browser.value(`document.getElementById("licences").textContent`);
  check(/GNU GENERAL PUBLIC LICENSE/.test(terms) && ["fftw3", "ceres-solver", "plotly.js", "libsndfile"].every((name) => terms.includes(`==== ${name}`)),
    "the licences of what the page is made of are in it");
}

export async function microphone(browser, { folder }) {
  await browser.value(`location.hash = "#microphone"`);
  await browser.value(`document.getElementById("microphone-period").value = ""`);
  await browser.click("#listen");
  await browser.until(`document.querySelector("#reading tbody tr")`, "a reading");
  const rows = await browser.value(`[...document.querySelectorAll("#reading tbody tr")].map((tr) => [...tr.children].map((td) => td.textContent))`);
  const period = parseFloat(rows[0][1]);
  check(Math.abs(period - 0.5) < 0.005, `the ticks of the microphone are heard: ${rows.map((row) => row.join(" ")).join("; ")}`);
  await browser.picture(join(folder, "microphone.png"), 1000);
  await browser.click("#stop-listening");
  await browser.until(`!document.getElementById("recorded").hidden`, "the recording");
  const { bytes } = await browser.savedBy(`document.querySelector("#save-recording a")`);
  check(bytes.subarray(0, 4).toString() === "RIFF" && bytes.length > 100000, `the recording can be saved: ${bytes.length} bytes of WAV`);
  await browser.click("#use-recording");
  await browser.until(done, "the report");
  check(await browser.value(`!document.getElementById("log-result").hidden`), `and reported on ${await browser.value("document.getElementById('log-failure').textContent")}`);
  await browser.value(`location.hash = "#microphone"`);
  await browser.value(`navigator.mediaDevices.getUserMedia = () => Promise.reject(new DOMException("no", "NotFoundError"))`);
  await browser.click("#listen");
  await pause(200);
  check(/There is no microphone/.test(await browser.value(`document.getElementById("microphone-says").textContent`)), "without a microphone it says so");
}
