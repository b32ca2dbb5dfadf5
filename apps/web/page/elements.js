// Helpers that build the elements of the page. Text from outside becomes text, never markup.

/** An element with properties and children; a string child is text. */
export function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (key in made && key !== "list" && key !== "form") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

export const byId = (id) => document.getElementById(id);

/** A table with a caption; the first cell of a row is its heading. */
export function table(caption, headings, rows) {
  const head = element("tr", {}, ...headings.map((text) => element("th", { scope: "col" }, text)));
  const body = rows.map((cells) => element("tr", {}, ...cells.map((cell, i) =>
    (i === 0 ? element("th", { scope: "row" }, cell) : element("td", { "data-label": headings[i] }, cell)))));
  return element("div", { className: "scroll", role: "region", tabIndex: 0, "aria-label": caption },
    element("table", {}, element("caption", {}, caption), element("thead", {}, head), element("tbody", {}, ...body)));
}

/** A link that saves bytes or text under a name. */
export function saveLink(name, content, type = "application/octet-stream") {
  return element("a", { href: URL.createObjectURL(new Blob([content], { type })), download: name.split("/").pop() }, name);
}

/** Saves bytes or text under a name, without a link to click. */
export function save(name, content, type) {
  const link = saveLink(name, content, type);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000); // ms: by then the browser has read the content
}

export function sizeText(bytes) {
  if (bytes < 1000) return `${bytes} bytes`;
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}
