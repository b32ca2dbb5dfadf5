// The worksheets of the course, each with its log.
import { byId, element, saveLink } from "./elements.js";
import { embeddedFiles } from "./embedded.js";
import { useFiles } from "./logs.js";
import { markdown } from "./markdown.js";

const folder = "data/course/";
const bytesOf = (text) => new TextEncoder().encode(text);
const titleOf = (text) => text.match(/^# (.*)/m)[1];

function showSheet(files, path) {
  const name = path.replace(/\.md$/, ".csv"), log = { name: name.slice(folder.length), bytes: bytesOf(files[name]) };
  const report = element("button", { type: "button" }, "Report on this sheet's log");
  report.addEventListener("click", () => { location.hash = "#logs"; useFiles([log]); });
  byId("sheet").replaceChildren(element("p", {}, report, " ", saveLink(log.name, log.bytes, "text/csv"), " ",
    saveLink(path.slice(folder.length), files[path], "text/markdown")), ...markdown(files[path]));
  for (const button of byId("sheets").querySelectorAll("button"))
    button.setAttribute("aria-pressed", String(button.dataset.path === path));
}

function sampleButton(files, path) {
  const name = path.split("/").pop();
  const button = element("button", { type: "button" }, name);
  button.addEventListener("click", () => useFiles([{ name, bytes: bytesOf(files[path]) }]));
  return button;
}

export async function beginWorksheets() {
  const files = await embeddedFiles();
  const sheets = Object.keys(files).filter((path) => path.startsWith(folder) && path.endsWith(".md"));
  for (const path of sheets) {
    const button = element("button", { type: "button", "aria-pressed": "false" }, titleOf(files[path]));
    button.dataset.path = path;
    button.addEventListener("click", () => showSheet(files, path));
    byId("sheets").append(element("li", {}, button));
  }
  const samples = Object.keys(files).filter((path) => path.startsWith("data/logs/"));
  byId("samples").append(...samples.map((path) => sampleButton(files, path)));
  byId("licences").textContent = files["licences.txt"];
}
