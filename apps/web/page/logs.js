// The part of the page that takes logs, shows their report, and offers its files to save.
import { Cancelled, pathsOf } from "./engine.js";
import { byId, element, sizeText } from "./elements.js";
import { Downloads, filesOf, furtherCommands, furtherWords } from "./downloads.js";
import { Progress } from "./progress.js";
import { freeName, roleOf, roles } from "./roles.js";
import { buildSettings, clearSettings, enterOptions, settingWords, showAssumed } from "./settings.js";

const withFiguresUpTo = 4e6; // bytes of logs: for more, figures and tables are written only on demand
const memoryLimit = 4e9; // bytes: what WebAssembly can address
const bytesAByte = 17; // bytes of memory for each byte of a log, about

let files = [], progress, downloads, reportAddress;

const withRole = (role) => files.filter((file) => file.role === role);
const logBytes = () => withRole("log").reduce((sum, file) => sum + file.bytes.length, 0);

// ---- messages

function showMessages(lines, failed) {
  const assumed = lines.filter((line) => line.startsWith("assumed: "));
  const shown = lines.filter((line) => line && !assumed.includes(line) && !/^the page is |need gnuplot/.test(line));
  byId("assumed").replaceChildren(...assumed.map((line) => element("li", {}, line.slice("assumed: ".length))));
  byId("notes").replaceChildren(...(failed ? [] : shown).map((line) => element("li", {}, line)));
  byId("assumed-part").hidden = assumed.length === 0;
  byId("notes-part").hidden = failed || shown.length === 0;
  const alert = byId("log-failure");
  alert.replaceChildren(...(failed ? shown.flatMap(failureLine) : []));
  alert.hidden = !failed;
  showAssumed(assumed);
}

// A line of advice, "  if a line is a period: --format periods", becomes a button that sets the option.
function failureLine(line) {
  const advice = line.match(/^ +if (.*): (--.*)$/);
  if (!advice) return [element("p", {}, line.replace(/^goingrate: /, ""))];
  const button = element("button", { type: "button" }, `If ${advice[1]}`);
  button.addEventListener("click", () => { enterOptions(advice[2]); analyse(); });
  return [element("p", {}, button)];
}

// ---- the list of files

function roleChoice(file) {
  const choice = element("select", { "aria-label": `${file.name} is a` },
    ...Object.entries(roles).map(([role, words]) => element("option", { value: role }, words)));
  choice.value = file.role;
  choice.addEventListener("change", () => { file.role = choice.value; analyse(); });
  return choice;
}

function showFiles() {
  byId("log-list").replaceChildren(...files.map((file) => {
    const away = element("button", { type: "button", "aria-label": `Remove ${file.name}` }, "Remove");
    away.addEventListener("click", () => { files = files.filter((other) => other !== file); showFiles(); analyse(); });
    return element("li", {}, element("span", { className: "name" }, file.name), ` ${sizeText(file.bytes.length)} `,
      roleChoice(file), " ", away);
  }));
  byId("log-chosen").hidden = files.length === 0;
}

function tooLarge() {
  if (logBytes() * bytesAByte < memoryLimit) return null;
  return `${sizeText(logBytes())} of logs may need more than the 4 GB of memory that a page can have. If it fails, ` +
    "use a part of the log, or the command on your computer.";
}

// ---- the report

function showReport(html) {
  if (reportAddress) URL.revokeObjectURL(reportAddress);
  reportAddress = html && URL.createObjectURL(new Blob([html], { type: "text/html" }));
  byId("log-result").hidden = !html;
  byId("report-page").replaceChildren(...(html ? [element("iframe", { title: "Clock report", src: reportAddress,
    sandbox: "allow-scripts allow-downloads" })] : []));
}

function reportWords(withFigures) {
  const also = withFigures ? ["--figures=/out/figures", "--tables=/out/tables"] : [];
  return ["report", ...pathsOf(withRole("log")), "-o", "/out/report.html", "--json=/out/report.json",
    "--diary-out=/out/diary.csv", ...also,
    ...pathsOf(withRole("weather")).map((path) => `--weather=${path}`),
    ...pathsOf(withRole("diary")).slice(0, 1).map((path) => `--diary=${path}`),
    ...settingWords(true, withRole("weather").length > 0)];
}

// Runs the command and shows its messages; returns null if it was cancelled or failed.
async function attempt(words) {
  try {
    const result = await progress.run(words, files);
    showMessages(result.err.split("\n"), result.code !== 0);
    return result.code === 0 ? result : null;
  } catch (error) {
    if (!(error instanceof Cancelled))
      showMessages([`goingrate: the program stopped with an error: ${error.message}`], true);
    return null;
  }
}

function showResult(result) {
  const page = result.files.find((file) => file.path === "report.html");
  downloads.clear();
  downloads.add([...result.files, { path: "summary.txt", bytes: new TextEncoder().encode(result.out) }]);
  byId("more-figures").hidden = result.files.some((file) => file.path.startsWith("figures/"));
  byId("more-compare").hidden = withRole("log").length < 2;
  byId("summary").textContent = result.out;
  showReport(page.bytes);
}

async function analyse(withFigures = logBytes() <= withFiguresUpTo) {
  showReport(null);
  byId("log-too-large").textContent = tooLarge() ?? "";
  if (withRole("log").length === 0) {
    progress.current?.cancel();
    return;
  }
  const result = await attempt(reportWords(withFigures));
  if (result) showResult(result);
}

async function runFurther(command) {
  const model = command === "fit" || command === "spectrum";
  const weather = pathsOf(withRole("weather")).map((path) => `--weather=${path}`);
  const words = furtherWords(command, withRole("log"), [...weather, ...settingWords(model, weather.length > 0)]
    .filter((word) => !/^--(nut-pitch|pendulum-length)/.test(word)));
  const result = await attempt(words);
  if (result) downloads.add(filesOf(command, result));
}

// ---- what the reader does

/** Replaces the list of files by files {name, bytes}, and reports on them. */
export function useFiles(taken) {
  files = [];
  clearSettings();
  addFiles(taken);
}

function addFiles(taken) {
  for (const { name, bytes } of taken) files.push({ name: freeName(name, files), bytes, role: roleOf(name, bytes) });
  showFiles();
  return analyse();
}

const contentOf = async (file) => ({ name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) });

async function addChosen(chosen) {
  try {
    await addFiles(await Promise.all([...chosen].map(contentOf)));
  } catch (error) {
    showMessages([`goingrate: a file could not be read: ${error.message}`], true);
  }
}

function takeDrops() {
  const place = document.documentElement;
  place.addEventListener("dragover", (event) => { event.preventDefault(); place.classList.add("dropping"); });
  place.addEventListener("dragleave", () => place.classList.remove("dropping"));
  place.addEventListener("drop", (event) => {
    event.preventDefault();
    place.classList.remove("dropping");
    if (event.dataTransfer.files.length === 0) return;
    location.hash = "#logs";
    addChosen(event.dataTransfer.files);
  });
}

export function beginLogs() {
  progress = new Progress(byId("log-progress"));
  progress.onCancelled = () => showMessages(["Cancelled. Change a setting, or choose another log."], true);
  downloads = new Downloads(byId("downloads"), byId("save-all"));
  const input = byId("log-files");
  input.addEventListener("change", () => { addChosen(input.files); input.value = ""; });
  buildSettings(byId("settings"), () => analyse());
  byId("forget").addEventListener("click", () => useFiles([]));
  byId("more-figures").addEventListener("click", () => analyse(true));
  for (const command of Object.keys(furtherCommands))
    byId(`more-${command}`).addEventListener("click", () => runFurther(command));
  takeDrops();
}
