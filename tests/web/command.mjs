// Runs the command that is embedded in a page, under node: as the page does, in a worker with files in memory.
import { readFileSync } from "node:fs";
import { Worker } from "node:worker_threads";
import { gunzipSync } from "node:zlib";

// What a worker of a browser has and one of node has under other names.
const browserWorker = `const { parentPort } = require("node:worker_threads");
globalThis.postMessage = (message, transferred) => parentPort.postMessage(message, transferred);
parentPort.on("message", (data) => globalThis.onmessage({ data }));
`;

export class Command {
  /** Of the page at this path. */
  static async of(path) {
    const page = readFileSync(path, "utf8");
    const content = (id) => {
      const from = page.indexOf(">", page.indexOf(`id="${id}"`)) + 1;
      return page.slice(from, page.indexOf("</script>", from));
    };
    const command = new Command();
    command.script = browserWorker + content("worker");
    command.module = await WebAssembly.compile(gunzipSync(Buffer.from(content("command"), "base64")));
    return command;
  }

  /** As `goingrate WORDS`, with files {name, bytes}: {code, out, err, files, stages, seconds}. */
  run(words, files) {
    const worker = new Worker(this.script, { eval: true, stderr: true });
    const stages = [], began = performance.now();
    return new Promise((resolve, reject) => {
      worker.on("error", reject);
      worker.on("message", (data) => {
        if (data.stage) stages.push(data.stage);
        if (data.broken) reject(new Error(data.broken));
        if (data.done) resolve({ ...data.done, stages, seconds: (performance.now() - began) / 1000 });
      });
      worker.postMessage({ module: this.module, words, files });
    }).finally(() => worker.terminate());
  }
}

export const textOf = (result, path) => {
  const file = result.files.find((made) => made.path === path);
  return file && new TextDecoder().decode(file.bytes);
};
