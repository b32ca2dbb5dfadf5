// page.mjs PAGE GOINGRATE SOURCE FOLDER CHROMIUM [PART ...]: opens the page in headless Chromium as a file, and does
// what a reader does. Pictures are kept in FOLDER, to be looked at. PARTs are those below; all if none is named.
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { Browser, check, faultCount } from "./driver.mjs";
import { hostile } from "./hostile.mjs";
import { ticking, wav } from "./logs.mjs";
import { keyboard, looks } from "./looks.mjs";
import { cancels, dropped, largest, report, settings } from "./reports.mjs";
import { licences, microphone, simulator, worksheets } from "./sources.mjs";

const [page, goingrate, source, folder, chromium, ...wanted] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const parts = { report, dropped, settings, cancels, hostile, simulator, worksheets, licences, microphone, looks, keyboard, largest };
const heard = join(folder, "heard.wav"); // what the microphone of the tests hears
writeFileSync(heard, wav(ticking(30, 0.5, 48000, () => 2 * Math.random() - 1), 48000));

for (const [name, part] of Object.entries(parts)) {
  if (wanted.length > 0 ? !wanted.includes(name) : name === "largest") continue;
  const browser = new Browser(chromium, name === "microphone"
    ? ["--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream", `--use-file-for-fake-audio-capture=${heard}`,
      "--autoplay-policy=no-user-gesture-required"] : []);
  try {
    await browser.open(page);
    await part(browser, { page, goingrate, source, folder });
    const outside = browser.requests.filter((address) => !/^(file|blob|data|about):/.test(address));
    check(outside.length === 0, `${name}: nothing is asked of a network ${outside.join(" ")}`);
    check(browser.complaints.length === 0, `${name}: no complaint on the console ${browser.complaints.join("; ").slice(0, 400)}`);
  } catch (error) {
    check(false, `${name}: ${error.stack}`);
  } finally {
    await browser.close();
  }
}
process.exit(faultCount() > 0 ? 1 : 0);
