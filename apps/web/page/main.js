// Puts the page together and shows the part that its address names.
import { compiledCommand } from "./embedded.js";
import { byId } from "./elements.js";
import { beginLogs } from "./logs.js";
import { beginMicrophone } from "./microphone.js";
import { beginSimulator } from "./simulator.js";
import { beginWorksheets } from "./worksheets.js";

const parts = ["logs", "simulator", "microphone", "worksheets", "about"];

function showPart() {
  const wanted = location.hash.slice(1);
  if (wanted === "main") return; // the skip link
  const shown = parts.includes(wanted) ? wanted : parts[0];
  for (const part of parts) byId(part).hidden = part !== shown;
  for (const link of document.querySelectorAll("nav a")) {
    if (link.hash === `#${shown}`) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  scrollTo(0, 0);
}

// In a browser that lacks these the page says so, instead of doing nothing.
const isTooOld = () => typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined";

function begin() {
  addEventListener("hashchange", showPart);
  showPart();
  if (isTooOld()) {
    byId("too-old").hidden = false;
    return;
  }
  beginLogs();
  beginSimulator();
  beginMicrophone();
  beginWorksheets();
  compiledCommand(); // starts now, while the reader is still looking for a file
  document.documentElement.dataset.ready = "true";
}

begin();
