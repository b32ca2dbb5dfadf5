// Turns the Markdown of the worksheets into elements of the page: headings, paragraphs, lists, tables, code,
// emphasis, formulas. Links stay text, because they lead to files that the page does not contain.
import { element } from "./elements.js";
import { mathematics } from "./mathematics.js";

const inlinePattern = /`([^`]+)`|\$([^$]+)\$|\*\*([^*]+)\*\*|\*([^*\s][^*]*)\*|\[([^\]]+)\]\([^)]*\)/g;

function inline(text) {
  const parts = [];
  let from = 0;
  for (const match of text.matchAll(inlinePattern)) {
    const [whole, code, tex, strong, emphasis, link] = match;
    parts.push(text.slice(from, match.index));
    if (code) parts.push(element("code", {}, code));
    else if (tex) parts.push(mathematics(tex, false));
    else if (strong) parts.push(element("strong", {}, ...inline(strong)));
    else if (emphasis) parts.push(element("em", {}, ...inline(emphasis)));
    else parts.push(...inline(link));
    from = match.index + whole.length;
  }
  parts.push(text.slice(from));
  return parts.filter((part) => part !== "");
}

const isListItem = (line) => /^(- |\d+\. )/.test(line);
const starts = (line) => line === "" || /^(#|```|\$\$|\|)/.test(line) || isListItem(line);

function takeWhile(lines, holds) {
  const taken = [];
  while (lines.length && holds(lines[0])) taken.push(lines.shift());
  return taken;
}

function codeBlock(lines) {
  lines.shift();
  const code = takeWhile(lines, (line) => !line.startsWith("```"));
  lines.shift();
  return element("pre", { tabIndex: 0 }, element("code", {}, code.join("\n")));
}

function formula(lines) {
  let tex = lines.shift();
  while (!tex.trimEnd().endsWith("$$") || tex.trim() === "$$") tex += `\n${lines.shift()}`;
  return element("div", { className: "formula", tabIndex: 0, role: "group", "aria-label": "Formula" },
    mathematics(tex.trim().slice(2, -2), true));
}

function listOf(lines) {
  const items = [];
  while (lines.length && isListItem(lines[0])) {
    const first = lines.shift().replace(/^(- |\d+\. )/, "");
    items.push([first, ...takeWhile(lines, (line) => /^ +\S/.test(line)).map((line) => line.trim())].join(" "));
  }
  return element("ul", {}, ...items.map((item) => element("li", {}, ...inline(item))));
}

function tableOf(lines) {
  const rows = takeWhile(lines, (line) => line.startsWith("|")).map((line) => line.slice(1, -1).split("|").map((cell) => cell.trim()));
  const [head, , ...body] = rows;
  return element("div", { className: "scroll", tabIndex: 0, role: "region", "aria-label": "Table" }, element("table", {},
    element("thead", {}, element("tr", {}, ...head.map((cell) => element("th", { scope: "col" }, ...inline(cell))))),
    element("tbody", {}, ...body.map((cells) => element("tr", {}, ...cells.map((cell) => element("td", {}, ...inline(cell))))))));
}

function block(lines) {
  const line = lines[0];
  if (line.startsWith("```")) return codeBlock(lines);
  if (line.startsWith("$$")) return formula(lines);
  if (line.startsWith("|")) return tableOf(lines);
  if (isListItem(line)) return listOf(lines);
  const heading = line.match(/^(#+) (.*)/);
  if (heading) {
    lines.shift();
    return element(`h${Math.min(6, heading[1].length + 2)}`, {}, ...inline(heading[2]));
  }
  const first = lines.shift();
  return element("p", {}, ...inline([first, ...takeWhile(lines, (next) => !starts(next))].join(" ")));
}

/** Elements for a text in Markdown; its first heading becomes an h3. */
export function markdown(text) {
  const lines = text.split("\n"), blocks = [];
  while (lines.length) {
    if (lines[0].trim() === "") lines.shift();
    else blocks.push(block(lines));
  }
  return blocks;
}
