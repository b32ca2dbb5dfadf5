// The role of a file that was dropped: a log, a weather file or a diary.

export const roles = { log: "log", weather: "weather", diary: "keeper's diary" };

const headBytes = 4096;

function headerOf(bytes) {
  const head = new TextDecoder().decode(bytes.subarray(0, headBytes));
  return (head.split(/\r?\n/).find((line) => line.trim() && !line.startsWith("#")) ?? "").toLowerCase();
}

/** The role of a file, guessed from its name and header; the reader can correct it. */
export function roleOf(name, bytes) {
  const header = headerOf(bytes);
  if (/(^|[,;\t])\s*"?what"?\s*[,;\t]/.test(header) || /diary|logbook/i.test(name)) return "diary";
  const weather = /temperature|pressure|humidity|baro/.test(header);
  const beats = /edge|width|period|amplitude|angle|phase|swing|tick|beat|error/.test(header);
  return (weather && !beats && !/pulse/.test(header)) || /weather/i.test(name) ? "weather" : "log";
}

/** The file's name, made different from those of the other files. */
export function freeName(name, files) {
  const taken = new Set(files.map((file) => file.name));
  const clean = name.replaceAll("/", "_") || "log";
  for (let n = 2, free = clean; ; free = clean.replace(/(\.[^.]*)?$/, (end) => ` (${n++})${end}`))
    if (!taken.has(free)) return free;
}
