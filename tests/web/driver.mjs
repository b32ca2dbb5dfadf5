// Drives headless Chromium by the DevTools protocol over a pipe (messages end with a zero byte), so that node
// needs no packages.
import { spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

const patience_ms = 600000; // until a run has ended, on a machine with other work

export class Browser {
  #waiting = new Map();
  #last = 0;
  #unread = Buffer.alloc(0);
  complaints = []; // what the console shows as error or warning
  requests = []; // every address that is asked for
  frames = new Map(); // sessions of frames by themselves

  constructor(chromium, flags = []) {
    this.profile = mkdtempSync(join(tmpdir(), "goingrate-web-"));
    this.saved = join(this.profile, "saved");
    mkdirSync(this.saved);
    this.process = spawn(chromium, ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
      "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
      `--user-data-dir=${this.profile}`, "--remote-debugging-pipe", ...flags],
    { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    this.process.stdio[4].on("data", (bytes) => this.#read(bytes));
  }

  #read(bytes) {
    this.#unread = Buffer.concat([this.#unread, bytes]);
    for (let end = this.#unread.indexOf(0); end >= 0; end = this.#unread.indexOf(0)) {
      this.#hear(JSON.parse(this.#unread.subarray(0, end)));
      this.#unread = this.#unread.subarray(end + 1);
    }
  }

  #hear({ id, method, params, result, error }) {
    if (id) {
      const { done, fail } = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error) fail(new Error(error.message));
      else done(result);
    }
    if (method === "Runtime.exceptionThrown") this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === "Runtime.consoleAPICalled" && ["error", "warning"].includes(params.type))
      this.complaints.push(params.args.map((a) => a.value ?? a.description).join(" "));
    if (method === "Log.entryAdded" && params.entry.level === "error") this.complaints.push(params.entry.text);
    if (method === "Network.requestWillBeSent") this.requests.push(params.request.url);
    if (method === "Target.attachedToTarget" && params.targetInfo.type === "iframe") this.frames.set(params.targetInfo.targetId, params.sessionId);
    if (method === "Target.detachedFromTarget") for (const [target, session] of this.frames) if (session === params.sessionId) this.frames.delete(target);
  }

  send(method, params = {}, sessionId = this.session) {
    const id = ++this.#last;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((done, fail) => this.#waiting.set(id, { done, fail }));
  }

  async open(page, hash = "") {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" }, undefined);
    ({ sessionId: this.session } = await this.send("Target.attachToTarget", { targetId, flatten: true }, undefined));
    for (const domain of ["Page", "Runtime", "Log", "Accessibility", "Network", "DOM"]) await this.send(`${domain}.enable`);
    await this.send("Target.setAutoAttach", { autoAttach: true, waitForDebuggerOnStart: false, flatten: true });
    await this.send("Page.setDownloadBehavior", { behavior: "allow", downloadPath: this.saved });
    await this.setWidth(1000);
    await this.send("Page.navigate", { url: page.startsWith("http:") ? page : pathToFileURL(resolve(page)).href + hash });
    await this.until(`document.documentElement.dataset.ready`, "the page is ready");
  }

  async value(expression, session = this.session) {
    const answer = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true }, session);
    if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description ?? answer.exceptionDetails.text);
    return answer.result.value;
  }

  async until(expression, what, session = this.session) {
    for (const began = Date.now(); Date.now() - began < patience_ms; await pause(50))
      if (await this.value(`Boolean(${expression})`, session).catch(() => false)) return;
    throw new Error(`waited in vain for: ${what}; ${this.complaints.join("; ")}`);
  }

  /** As a reader does who chooses files. */
  async choose(selector, paths) {
    const { root } = await this.send("DOM.getDocument");
    const { nodeId } = await this.send("DOM.querySelector", { nodeId: root.nodeId, selector });
    await this.send("DOM.setFileInputFiles", { nodeId, files: paths.map((path) => resolve(path)) });
  }

  click(selector) {
    return this.value(`document.querySelector(${JSON.stringify(selector)}).click()`);
  }

  async press(key, code = key) {
    const virtual = { Tab: 9, Enter: 13, " ": 32, ArrowRight: 39 }[key];
    const text = { Enter: "\r", " ": " " }[key];
    await this.send("Input.dispatchKeyEvent", { type: "keyDown", key, code, text, windowsVirtualKeyCode: virtual });
    await this.send("Input.dispatchKeyEvent", { type: "keyUp", key, code, windowsVirtualKeyCode: virtual });
  }

  /** What a link saves. */
  async savedBy(link) {
    const before = new Set(readdirSync(this.saved));
    await this.value(`(${link}).click()`);
    for (const began = Date.now(); Date.now() - began < patience_ms; await pause(50)) {
      const made = readdirSync(this.saved).find((name) => !before.has(name) && !name.endsWith(".crdownload"));
      if (made) return { name: made, bytes: readFileSync(join(this.saved, made)) };
    }
    throw new Error("nothing was saved");
  }

  async setWidth(width) {
    await this.send("Emulation.setDeviceMetricsOverride", { width, height: 900, deviceScaleFactor: 1, mobile: width < 600 });
    await pause(300);
  }

  async setScheme(scheme) {
    await this.send("Emulation.setEmulatedMedia", { features: scheme ? [{ name: "prefers-color-scheme", value: scheme }] : [] });
  }

  async picture(path, width) {
    const height = Math.min(3000, await this.value("document.documentElement.scrollHeight"));
    const { data } = await this.send("Page.captureScreenshot", { captureBeyondViewport: true, clip: { x: 0, y: 0, width, height, scale: 1 } });
    writeFileSync(path, Buffer.from(data, "base64"));
  }

  async close() {
    const gone = new Promise((done) => this.process.once("exit", done));
    this.process.kill();
    await gone;
    try {
      rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
    } catch {
      // A helper of the browser may still write to it: what is left in the folder for temporary files is no fault.
    }
  }
}

let faults = 0;
export function check(holds, what) {
  console.log(`${holds ? "ok   " : "FAULT"} ${what}`);
  if (!holds) ++faults;
  return holds;
}
export const faultCount = () => faults;
