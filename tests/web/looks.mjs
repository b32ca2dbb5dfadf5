// What must be true of every part of the page at every width: nothing scrolls sideways, all text has the contrast
// that WCAG's level AA asks for, and every control has a name.
import { join } from "node:path";
import { check, pause } from "./driver.mjs";
import { done } from "./reports.mjs";

const luminance = `(c) => { const f = (v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  return 0.2126 * f(c[0]) + 0.7152 * f(c[1]) + 0.0722 * f(c[2]); }`;

/** Texts with too little contrast: 4.5, or 3 for large ones. */
export const faint = `(() => {
  const of = ${luminance}, parts = (text) => (text.match(/[\\d.]+/g) ?? []).map(Number);
  const ground = (e) => { for (; e; e = e.parentElement) { const c = parts(getComputedStyle(e).backgroundColor); if (c.length && (c.length < 4 || c[3] > 0)) return c; }
    return matchMedia("(prefers-color-scheme: dark)").matches ? [18, 18, 18] : [255, 255, 255]; };
  const found = [];
  for (const e of document.body.querySelectorAll("*")) {
    if (!e.getClientRects().length || e.closest("script, [hidden]") || e.namespaceURI.endsWith("MathML")) continue;
    const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()) || e.matches("input, select");
    if (!own || e.closest("progress")) continue;
    const style = getComputedStyle(e), a = of(parts(style.color)), b = of(ground(e));
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    if (contrast < (large ? 3 : 4.5)) found.push(e.tagName + " '" + (e.textContent || e.id).trim().slice(0, 30) + "' " + contrast.toFixed(2));
    if (e.matches("input[type=text]")) { const p = of(parts(getComputedStyle(e, "::placeholder").color));
      if ((Math.max(p, b) + 0.05) / (Math.min(p, b) + 0.05) < 4.5) found.push("placeholder of " + e.id); }
  }
  return [...new Set(found)].slice(0, 6);
})()`;

/** What reaches beyond the page. */
export const misfits = `(() => {
  const room = document.documentElement.clientWidth, found = [];
  if (document.documentElement.scrollWidth > room) found.push("the page scrolls sideways");
  for (const e of document.body.querySelectorAll("*")) {
    if (e.closest("pre, .scroll, .formula, .skip, [hidden], script") && !e.matches("pre, .scroll, .formula")) continue;
    const box = e.getBoundingClientRect();
    if (box.width && box.right > room + 0.5) found.push(e.tagName + "." + e.className + "#" + e.id + " reaches beyond the page");
  }
  return [...new Set(found)].slice(0, 5);
})()`;

/** Roles of what a screen reader announces without a name. */
export async function nameless(browser) {
  const { nodes } = await browser.send("Accessibility.getFullAXTree");
  const roles = ["button", "link", "image", "img", "region", "textbox", "combobox", "checkbox", "slider", "heading", "progressbar", "Iframe"];
  return nodes.filter((node) => !node.ignored && roles.includes(node.role?.value) && !node.name?.value).map((node) => node.role.value);
}

const parts = ["logs", "simulator", "microphone", "worksheets", "about"];

export async function looks(browser, { source, folder }) {
  await browser.choose("input[type=file]", [join(source, "data/course/2-ring-down.csv")]);
  await browser.until(done, "the report");
  await browser.value(`for (const e of document.querySelectorAll("details")) e.open = true;
    document.querySelectorAll("#sheets button")[2].click(); document.getElementById("simulated").hidden = false;`);
  for (const scheme of ["light", "dark"]) {
    await browser.setScheme(scheme);
    for (const width of [390, 768, 1280]) {
      await browser.setWidth(width);
      const found = [];
      for (const part of parts) {
        await browser.value(`location.hash = "#${part}"`);
        await pause(100);
        found.push(...(await browser.value(misfits)), ...(await browser.value(faint)));
        await browser.picture(join(folder, `${part}-${scheme}-${width}.png`), width);
      }
      check(found.length === 0, `${scheme}, ${width} px: nothing scrolls sideways, all text stands out ${found.join("; ")}`);
    }
  }
  await browser.setScheme("");
  for (const part of parts) {
    await browser.value(`location.hash = "#${part}"`);
    await pause(100);
    const missing = await nameless(browser);
    check(missing.length === 0, `${part}: all that a screen reader announces has a name ${missing.join(" ")}`);
  }
}

const focused = `(() => { const e = document.activeElement, s = getComputedStyle(e);
  return { what: e === document.body ? "" : e.id || e.textContent.trim().slice(0, 20), seen: s.outlineStyle !== "none" && parseFloat(s.outlineWidth) > 0, width: e.getBoundingClientRect().width }; })()`;

/** By the keyboard alone: all that can be used is reached by Tab in the order of the page, and shows that it is. */
export async function keyboard(browser) {
  await browser.press("Tab");
  check((await browser.value(focused)).what === "Skip to the content", "the first stop leads past the head");
  const stops = [];
  for (let i = 0; i < 60; ++i) {
    stops.push(await browser.value(focused));
    await browser.press("Tab");
  }
  const names = stops.map((stop) => stop.what);
  for (const name of ["Simulate a clock", "log-files", "jump.csv"]) check(names.includes(name), `Tab reaches ${name}`);
  const unseen = stops.filter((stop) => stop.what && stop.width > 0 && !stop.seen).map((stop) => stop.what);
  check(unseen.length === 0, `what has the focus shows it ${unseen.join(", ")}`);
  await browser.value(`[...document.querySelectorAll("#samples button")].find((b) => b.textContent === "jump.csv").focus()`);
  await browser.press("Enter");
  await browser.until(done, "the report");
  check(await browser.value(`!document.getElementById("log-result").hidden`), "a sample is reported on by Enter alone");
  await browser.value(`document.querySelector("nav a[href='#simulator']").focus()`);
  await browser.press("Enter");
  await browser.until(`!document.getElementById("simulator").hidden`, "the simulator");
  await browser.value(`document.getElementById("slider-epsilon").focus()`);
  const before = await browser.value(`document.querySelector("#slider-epsilon + output").textContent`);
  await browser.press("ArrowRight");
  check(await browser.value(`document.querySelector("#slider-epsilon + output").textContent`) !== before, "an arrow key moves a slider");
}
