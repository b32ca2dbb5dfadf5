// Runs the command of goingrate in a worker.
import { compiledCommand, scriptAddress } from "./embedded.js";

/** The run was cancelled. */
export class Cancelled extends Error {}

let workerAddress;

// A name that cannot be taken for an option, even if the file is called "-x".
const asPath = (name) => (name.startsWith("-") ? `./${name}` : name);

/** The words of a command line for files of these names. */
export const pathsOf = (files) => files.map((file) => asPath(file.name));

function listen(worker, onStage) {
  return new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => {
      if (data.done) resolve(data.done);
      else if (data.broken) reject(new Error(data.broken));
      else onStage?.(data.stage, data.share);
    };
    worker.onerror = (event) => reject(new Error(event.message));
  });
}

/**
 * Starts `goingrate WORDS` on files {name, bytes} that lie in its folder. What it writes below /out is in the
 * result: {code, out, err, files: [{path, bytes}]}. Gives {result, cancel}; a cancelled result rejects.
 */
export function start(words, files, onStage) {
  let worker, stop;
  const cancelled = new Promise((_, reject) => { stop = () => reject(new Cancelled("cancelled")); });
  const work = async () => {
    const module = await compiledCommand();
    workerAddress ??= scriptAddress("worker");
    worker = new Worker(workerAddress);
    const done = listen(worker, onStage);
    const copies = files.map(({ name, bytes }) => ({ name, bytes: bytes.slice() }));
    worker.postMessage({ module, words, files: copies }, copies.map((file) => file.bytes.buffer));
    return done;
  };
  const result = Promise.race([work(), cancelled]).finally(() => worker?.terminate());
  return { result, cancel: () => { worker?.terminate(); stop(); } };
}

/** Text of a file of a result; nothing if it has none. */
export function textOf(result, path) {
  const file = result.files.find((made) => made.path === path);
  return file && new TextDecoder().decode(file.bytes);
}
