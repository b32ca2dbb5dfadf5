// One run of the command. Each run has a worker of its own, so that it starts with fresh memory, and ending the
// worker cancels it. Receives {module, words, files}; posts stages while it works and {code, out, err, files} at the
// end.
"use strict";

const textOf = (bytes) => new TextDecoder().decode(new Uint8Array(bytes));

// All files below a folder, by their paths in it.
function filesIn(FS, folder, prefix = "") {
  return FS.readdir(folder).filter((name) => name !== "." && name !== "..").flatMap((name) => {
    const path = `${folder}/${name}`;
    if (FS.isDir(FS.stat(path).mode)) return filesIn(FS, path, `${prefix}${name}/`);
    return [{ path: prefix + name, bytes: FS.readFile(path) }];
  });
}

async function run({ module, words, files }) {
  const out = [], err = [];
  let code = 0;
  const program = await startGoingrate({
    // Output byte by byte, not as a terminal, so that every note keeps a line of its own.
    preRun: [({ FS }) => FS.init(() => null, (byte) => out.push(byte), (byte) => err.push(byte))],
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then((instance) => done(instance, module));
      return {};
    },
    onStage: (stage, share) => postMessage({ stage, share }),
    onExit: (status) => { code = status; },
    quit: (_, ended) => { throw ended; }, // ends the run alone, not the whole process, as it would under node
  });
  const { FS } = program;
  FS.ignorePermissions = true; // otherwise the umask makes new files unreadable
  FS.mkdir("/logs");
  FS.mkdir("/out");
  FS.mkdir(`/out/${words[0]}`); // for the files of a command other than report
  FS.chdir("/logs");
  for (const { name, bytes } of files) FS.writeFile(name, bytes, { canOwn: true });
  try {
    program.callMain(words);
  } catch (error) {
    if (error?.name !== "ExitStatus") throw error;
    code = error.status;
  }
  const made = filesIn(FS, "/out");
  postMessage({ done: { code, out: textOf(out), err: textOf(err), files: made } }, made.map((file) => file.bytes.buffer));
}

onmessage = ({ data }) => run(data).catch((error) => postMessage({ broken: String(error?.message ?? error) }));
