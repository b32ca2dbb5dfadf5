// Unpacks what build.sh packs into the page: gzip, then base64, in elements that no browser executes.

function bytesOf(id) {
  const text = atob(document.getElementById(id).textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

function unpacked(id) {
  const stream = new Blob([bytesOf(id)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream);
}

let module, contents;

/** The command, compiled once for all runs. */
export function compiledCommand() {
  module ??= unpacked("command").arrayBuffer().then((bytes) => WebAssembly.compile(bytes));
  return module;
}

/** Sample logs, worksheets and licences: {path: text}. */
export function embeddedFiles() {
  contents ??= unpacked("contents").json();
  return contents;
}

/** An address (URL) from which a worker can load the script in an element. */
export function scriptAddress(id) {
  return URL.createObjectURL(new Blob([document.getElementById(id).textContent], { type: "text/javascript" }));
}
