// Runs the command of goingrate in a worker.
import { compiledCommand, scriptAddress } from "./embedded.js";

/** Thrown by a run that was cancelled. */
export class Cancelled extends Error {}

let workerAddress;

// A path that the command cannot take for an option, even if the file is called "-x".
const asPath = (name) => (name.startsWith("-") ? `./${name}` : name);

/** The names of files as words of a command line. */
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
 * Starts `goingrate WORDS` with files {name, bytes} in its working folder. Returns {result, cancel}: `result` is a
 * promise of {code, out, err, files: [{path, bytes}]}, where `files` is what the command wrote below /out. Calling
 * `cancel` rejects it with Cancelled.
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

/** Text of one file of a result; undefined if there is no such file. */
export function textOf(result, path) {
  const file = result.files.find((made) => made.path === path);
  return file && new TextDecoder().decode(file.bytes);
}
