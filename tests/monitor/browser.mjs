// The page of a monitor in headless Chromium. Arguments: CHROMIUM ADDRESS FOLDER-FOR-PICTURES.
import { Browser, check, faultCount, pause } from "../web/driver.mjs";
import { writeFileSync } from "node:fs";
import { get } from "node:http";
import { join } from "node:path";

const [chromium, address, folder] = process.argv.slice(2);
const browser = new Browser(chromium);
await browser.open(address);
await browser.until(`document.querySelector("#rate .line")`, "the rate is drawn");
check(await browser.value(`document.querySelector("h1").textContent`) === "<i>Hall</i> clock", "the name is text");
check(/^The clock gains [0-9.]+ ± [0-9.]+ s\/day\.$/.test(await browser.value(`document.getElementById("says").textContent`)), "the first line tells the rate");
await browser.until(`document.getElementById("diary").textContent.includes("not heard")`, "the diary tells of breaks");
const diary = await browser.value(`document.getElementById("diary").textContent`);
check(/not heard for 30 beats; that count is right with probability 0\.9999/.test(diary), "the diary tells a break that is counted");
check(/not heard for about 200 beats, or it stood still: they cannot be counted/.test(diary), "and one that is not");
const beats = () => browser.value(`[...document.querySelectorAll("#cards div")].find((d) => d.textContent.startsWith("beats")).querySelector("dd").textContent`);
const before = Number(await beats());
await pause(4000);
const after = Number(await beats());
check(after > before, `it is live: ${before} beats, then ${after}`);
for (const scheme of ["light", "dark"]) {
  await browser.setScheme(scheme);
  for (const width of [390, 768, 1280]) {
    await browser.setWidth(width);
    await browser.until(`document.getElementById("rate").viewBox.baseVal.width === Math.max(320, document.getElementById("rate").clientWidth)`, "the figures fit the page");
    const wide = await browser.value(`document.documentElement.scrollWidth`);
    check(wide <= width, `${scheme}, ${width} px: nothing scrolls sideways (${wide})`);
    const { data } = await browser.send("Page.captureScreenshot", { format: "png", captureBeyondViewport: true });
    writeFileSync(join(folder, `monitor-${scheme}-${width}.png`), Buffer.from(data, "base64"));
  }
}
await browser.click("input[value=hours]");
await pause(500);
check(await browser.value(`document.querySelector("#rate .line, #rate text") !== null`), "hours are drawn");
check(browser.complaints.length === 0, `the console is silent ${browser.complaints.join("; ")}`);
check(browser.requests.every((url) => url.startsWith(address)), "nothing is asked of others");

// While sixteen others listen the page shows the state as it was, and is live again when they have gone.
const listen = () => new Promise((done) => get(address + "events", (answer) => done(answer)).on("error", () => done(null)));
const others = [];
await browser.send("Page.navigate", { url: "about:blank" });
while (others.length < 16) {
  const answer = await listen();
  if (answer?.statusCode === 200) others.push(answer.on("data", () => {}).on("error", () => {}));
  else await pause(1000); // the page's own place is free when its end is noticed
}
await browser.send("Page.navigate", { url: address });
await browser.until(`document.querySelector("#cards dd")`, "the one too many is shown how the clock goes");
const shown = Number(await beats());
await pause(4000);
check(Number(await beats()) === shown, `it is not live: ${shown} beats`);
for (const answer of others) answer.destroy();
await browser.until(`Number([...document.querySelectorAll("#cards div")].find((d) => d.textContent.startsWith("beats")).querySelector("dd").textContent) > ${shown + 5}`, "it asks again and is live");
check(true, `and live when others have gone`);
check(browser.complaints.every((words) => words.includes("503")), `the console tells of the refusal alone ${browser.complaints.join("; ")}`);
await browser.close?.();
process.exit(faultCount() === 0 ? 0 : 1);
