// The form of what is known about a log: each field is an option of the command. A field shows the value that
// the command chose by itself; a value entered there is passed to the command.
import { byId, element } from "./elements.js";

const formats = ["timestamps", "periods", "clock-error", "phase", "frequency", "ticc", "ticc-interval", "table",
  "angle", "ticktock", "xy", "labx", "zip", "wav", "native"];

// kind: number, text, flag, or a list of choices. `words` takes several values, separated by blanks; each becomes
// an option of its own.
const groups = [
  { title: "How the log is read", fields: [
    { option: "--format", label: "Format", kind: formats },
    { option: "--nominal-period", label: "Nominal period T0, s", kind: "number", hint: "the period to compare with" },
    { option: "--unit", label: "Unit of the times", kind: ["s", "ms", "us", "ns", "min", "h", "d", "mjd"] },
    { option: "--column", label: "Columns", kind: "words", hint: "ROLE=PLACE[:UNIT], as time=2 amplitude=5:mrad" },
    { option: "--wrap", label: "Times start again after, s", kind: "number", hint: "0: they never do" },
    { option: "--tau0", label: "Time between values, s", kind: "number", hint: "of phase, frequency or intervals" },
    { option: "--date-order", label: "First in dates such as 03/04/2013", kind: ["day", "month"] },
    { option: "--counter-hz", label: "Frequency of the counter, Hz", kind: "number", hint: "for ticktock" },
    { option: "--decimal-comma", label: "Decimal comma: 12,5 is twelve and a half", kind: "flag" },
    { option: "--channel", label: "Channel", kind: "words", hint: "TICC: chA; recording: beat=1 pps=2" },
    { option: "--clock-ppm", label: "σ of a recording's sampling rate, parts per million", kind: "number", hint: "50" },
  ] },
  { title: "The sensor", fields: [
    { option: "--both-edges", label: "Times of both directions, without labels", kind: "flag" },
    { option: "--flag-width", label: "Flag's angle seen from the pivot, rad", kind: "number", hint: "not given" },
    { option: "--gravity-share", label: "Gravity's share of the restoring torque", kind: "number", hint: "1; torsion: 0" },
    { option: "--sensor-offset", label: "Sensor's angle from the vertical, rad", kind: "text", hint: "a number, or auto" },
    { option: "--dead-time", label: "The contact bounces for, s", kind: "number" },
    { option: "--rest-angle", label: "Angle of the pendulum at rest, rad", kind: "number", hint: "for angle samples" },
    { option: "--gap-probability", label: "Split at a gap less certain than", kind: "number", hint: "a probability" },
    { option: "--weather-zone", label: "Time zone of the weather files", kind: "text", hint: "+01:00" },
  ] },
  { title: "The model", fields: [
    { option: "--fix", label: "Parameters held fixed", kind: "words", hint: "T0=2 mu=2e-5" },
    { option: "--free", label: "Fit as well", kind: "text", hint: "drift,offset,dry_friction" },
    { option: "--prior", label: "Known from elsewhere", kind: "words", hint: "lambda0=0.05+-0.005" },
    { option: "--event", label: "Changes", kind: "words", hint: "auto, none, or CYCLE:NAME, as 150:mu" },
    { option: "--model", label: "Equations", kind: ["auto", "averaged1", "averaged2", "map"] },
    { option: "--noise", label: "Noise", kind: ["auto", "jitter", "drive", "both", "slow"] },
    { option: "--escapement", label: "Escapement", kind: ["auto", "constant-torque", "single-impulse", "none"] },
    { option: "--nut-pitch", label: "Pitch of the rating nut, mm per turn", kind: "number", hint: "not given" },
    { option: "--pendulum-length", label: "Length of the pendulum, m", kind: "number", hint: "for the nut" },
  ] },
];

const idOf = (option) => `set${option.slice(1)}`;
const fields = groups.flatMap((group) => group.fields);

function controlOf({ option, kind, hint }) {
  const id = idOf(option);
  if (kind === "flag") return element("input", { id, type: "checkbox" });
  if (Array.isArray(kind))
    return element("select", { id }, element("option", { value: "" }, "automatic"),
      ...kind.map((choice) => element("option", { value: choice }, choice)));
  return element("input", { id, type: "text", placeholder: hint ?? "automatic", autocomplete: "off", spellcheck: false,
    inputMode: kind === "number" ? "decimal" : undefined });
}

/** Fills the form; `changed` is called when the reader has changed a field. */
export function buildSettings(form, changed) {
  for (const { title, fields: members } of groups)
    form.append(element("fieldset", {}, element("legend", {}, title), ...members.map((field) =>
      element("div", { className: field.kind === "flag" ? "field flag" : "field" },
        element("label", { htmlFor: idOf(field.option) }, field.label), controlOf(field)))));
  form.addEventListener("change", changed);
  form.addEventListener("submit", (event) => event.preventDefault());
}

const shared = new Set(groups[0].fields.concat(groups[1].fields).map((field) => field.option));

/** What was entered, as words of a command line; the options of the model only if `forReport`. */
export function settingWords(forReport, hasWeather) {
  return fields.flatMap(({ option, kind }) => {
    if ((!forReport && !shared.has(option)) || (option === "--weather-zone" && !hasWeather)) return [];
    const control = byId(idOf(option));
    if (kind === "flag") return control.checked ? [option] : [];
    const value = control.value.trim();
    if (!value) return [];
    // "--option=value": a value may begin with a minus.
    return kind === "words" ? value.split(/\s+/).map((word) => `${option}=${word}`) : [`${option}=${value}`];
  });
}

// What the command assumed instead of an option: lines that end in "(see --option value)", or name the period.
function assumedFor(option, lines) {
  const line = lines.find((one) => one.match(/\(see (--[a-z0-9-]+)(?: .*)?\)$/)?.[1] === option) ?? "";
  const value = line.match(/\(see --[a-z0-9-]+ (.*)\)$/)?.[1] ?? line.match(/nominal period ([\d.]+) s/)?.[1];
  return /[A-Z]$/.test(value ?? "") ? undefined : value; // "time=N" is a placeholder, not a value
}

/** Shows in the fields what the command assumed. */
export function showAssumed(lines) {
  for (const field of fields) {
    const control = byId(idOf(field.option)), value = assumedFor(field.option, lines);
    if (Array.isArray(field.kind)) control.options[0].textContent = value ? `automatic: ${value}` : "automatic";
    else if (field.kind !== "flag") control.placeholder = value ? `automatic: ${value}` : field.hint ?? "automatic";
  }
}

export function clearSettings() {
  for (const { option, kind } of fields) {
    const control = byId(idOf(option));
    if (kind === "flag") control.checked = false;
    else control.value = "";
  }
}

/** Enters options given as words: "--format periods --unit us". */
export function enterOptions(text) {
  for (const part of text.split(/(?:^|\s)(?=--)/)) {
    const [option, ...values] = part.trim().split(/\s+/);
    const field = fields.find((known) => known.option === option);
    if (!field) continue;
    const control = byId(idOf(option));
    if (field.kind === "flag") control.checked = true;
    else control.value = field.kind === "words" && control.value ? `${control.value} ${values.join(" ")}` : values.join(" ");
  }
}
