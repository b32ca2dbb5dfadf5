// Logs with script in their name, header, comments and values: nothing of it runs, nothing becomes markup.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { check } from "./driver.mjs";
import { choose, done } from "./reports.mjs";

const attack = (where) => `<img src=x onerror="parent.postMessage('${where}','*');window.broken='${where}'"><script>window.broken='${where}'</script>`;

export function hostileLogs(folder, source) {
  const times = readFileSync(join(source, "data/course/2-ring-down.csv"), "utf8").split("\n").filter((line) => /^[-0-9]/.test(line));
  const write = (name, lines) => { writeFileSync(join(folder, name), lines.join("\n")); return join(folder, name); };
  const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
  return {
    name: [write("<img src=x onerror=window.broken=1>.csv", ["time_s", ...times])],
    comments: [write("comments.csv", ["# goingrate log: 1", `# ${attack("comment")}`, `# nominal_period_s: 2`, "time_s", `# ${attack("inner")}`, ...times])],
    header: [write("header.csv", [`time_s,${quoted(attack("header"))}`, ...times.map((time) => `${time},1`)])],
    values: [write("values.csv", ["time_s,note", ...times.map((time, i) => (i % 5 ? `${time},ok` : `${attack("value").replaceAll(",", ";")},x`))])],
    diary: [write("d.csv", ["time_s", ...times]), write("diary.csv", ["time,what,value,sigma,note", `100,note,,,${quoted(attack("diary"))}`])],
  };
}

export async function hostile(browser, { folder, source }) {
  await browser.value(`addEventListener("message", (event) => { window.broken = String(event.data); })`);
  for (const [where, paths] of Object.entries(hostileLogs(folder, source))) {
    await browser.value(`document.getElementById("forget").click()`);
    await choose(browser, paths);
    await browser.until(done, `an answer to script in ${where}`);
    await browser.until("true", "a moment");
    const said = await browser.value(`document.getElementById("log-failure").textContent.slice(0, 160)`);
    let inside = 0;
    for (const session of browser.frames.values())
      inside += await browser.value(`Number(Boolean(window.broken)) + document.querySelectorAll("img[src=x], script:not([type])[src]").length`, session).catch(() => 0);
    const broken = await browser.value(`window.broken ?? ""`);
    const made = await browser.value(`document.querySelectorAll("img[src=x]").length`);
    check(!broken && made === 0 && inside === 0, `script in ${where} stays text ${broken} ${said ? `(${said})` : ""}`);
  }
  const evaluated = await browser.send("Runtime.evaluate", { expression: `new Function("return 1")()`, allowUnsafeEvalBlockedByCSP: false });
  check(evaluated.exceptionDetails?.exception?.className === "EvalError", "the page cannot evaluate text as script");
  const asked = await browser.value(`fetch("https://example.org/").then(() => "asked", (error) => error.name)`);
  check(asked === "TypeError", "the page cannot ask a network");
  const added = await browser.value(`(() => { const s = document.createElement("script"); s.textContent = "window.broken = 'inline'"; document.body.append(s); return window.broken ?? ""; })()`);
  check(added === "", "no script that is added to the page runs");
  browser.complaints.length = 0; // what was blocked just now complains
  browser.requests.length = 0;
}
