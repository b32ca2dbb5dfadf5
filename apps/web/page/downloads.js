// Offers the files that a run wrote to be saved, each by itself or all as a ZIP. Other commands write more on demand.
import { zipOf } from "./archive.js";
import { pathsOf, textOf } from "./engine.js";
import { element, save, saveLink, sizeText } from "./elements.js";

const types = { html: "text/html", svg: "image/svg+xml", csv: "text/csv", json: "application/json", txt: "text/plain" };
const typeOf = (path) => types[path.split(".").pop()] ?? "application/octet-stream";

const folderOf = (path) => (path.includes("/") ? path.split("/")[0] : "");
const headings = { "": "Report", figures: "Figures: SVG, values as CSV, scripts for gnuplot", tables: "Tables",
  rate: "Beats and rates; the log for other programs", fit: "Fit", spectrum: "Spectrum", stability: "Stability",
  compare: "The logs compared" };

/** Commands that write more files from the same logs, with the options that name those files. */
export const furtherCommands = {
  rate: ["-o", "/out/rate/rates.csv", "--json=/out/rate/rate.json", "--native=/out/rate/log.csv",
    "--phase=/out/rate/phase.txt", "--ticc=/out/rate/ticc.txt", "--par=/out/rate/rate.par", "--plot=/out/rate/rate.svg"],
  fit: ["--json=/out/fit/fit.json", "--par=/out/fit/fit.par", "--csv=/out/fit/fit.csv", "--latex=/out/fit/fit.tex",
    "--plot=/out/fit/fit.svg"],
  spectrum: ["-o", "/out/spectrum/spectrum.csv", "--json=/out/spectrum/spectrum.json", "--plot=/out/spectrum/spectrum.svg"],
  stability: ["-o", "/out/stability/stability.txt", "--json=/out/stability/stability.json",
    "--plot=/out/stability/stability.svg"],
  compare: ["--json=/out/compare/compare.json", "--rates=/out/compare/rates.csv", "--plot=/out/compare/compare.svg"],
};

export class Downloads {
  constructor(place, allButton) {
    this.place = place;
    this.files = [];
    allButton.addEventListener("click", async () => save("goingrate.zip", await zipOf(this.files), "application/zip"));
  }

  clear() {
    for (const link of this.place.querySelectorAll("a")) URL.revokeObjectURL(link.href);
    this.place.replaceChildren();
    this.files = [];
  }

  add(files) {
    const folders = Map.groupBy ? Map.groupBy(files, (file) => folderOf(file.path)) : groupsOf(files);
    for (const [folder, members] of folders)
      this.place.append(element("details", { open: folder === "" },
        element("summary", {}, `${headings[folder] ?? folder} (${members.length})`),
        element("ul", { className: "files" }, ...members.map((file) => element("li", {},
          saveLink(file.path, file.bytes, typeOf(file.path)), ` ${sizeText(file.bytes.length)}`)))));
    this.files.push(...files);
  }
}

function groupsOf(files) {
  const groups = new Map();
  for (const file of files) groups.set(folderOf(file.path), [...(groups.get(folderOf(file.path)) ?? []), file]);
  return groups;
}

/** The files of a run and what it printed, in a folder with the command's name. */
export function filesOf(command, result) {
  const printed = result.out && !textOf(result, `${command}/${command}.txt`)
    ? [{ path: `${command}/${command}.txt`, bytes: new TextEncoder().encode(result.out) }] : [];
  return [...result.files, ...printed];
}

/** The command line, as words, that runs a further command on logs. */
export const furtherWords = (command, logs, settings) => [command, ...pathsOf(logs), ...furtherCommands[command], ...settings];
