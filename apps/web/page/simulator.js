// Simulates and fits the log of a clock set by sliders, and shows its parameters beside the fitted ones.
import { Cancelled, textOf } from "./engine.js";
import { byId, element, table } from "./elements.js";
import { useFiles } from "./logs.js";
import { shortNumber, withSigma } from "./numbers.js";
import { Progress } from "./progress.js";
import { scenarioText, sliders } from "./scenario.js";

const stepsOfALogarithm = 300; // of a slider, from one end to the other
let progress, log;

const inputOf = (key) => byId(`slider-${key}`);

function valueOf(slider) {
  const raw = Number(inputOf(slider.key).value);
  if (!slider.logarithmic) return raw;
  const ratio = slider.greatest / slider.least;
  return Number((slider.least * ratio ** (raw / stepsOfALogarithm)).toPrecision(2)); // two digits, as shown
}

function placeOf(slider) {
  if (!slider.logarithmic) return slider.usual;
  return Math.round(stepsOfALogarithm * Math.log(slider.usual / slider.least) / Math.log(slider.greatest / slider.least));
}

function sliderRow(slider) {
  const input = element("input", { id: `slider-${slider.key}`, type: "range", min: slider.logarithmic ? 0 : slider.least,
    max: slider.logarithmic ? stepsOfALogarithm : slider.greatest, step: slider.logarithmic ? 1 : slider.step });
  input.value = placeOf(slider);
  const shown = element("output", { htmlFor: input.id });
  const show = () => {
    shown.textContent = shortNumber(valueOf(slider));
    input.setAttribute("aria-valuetext", shown.textContent);
    if (byId("scenario")) byId("scenario").textContent = scenarioText(clockOfSliders());
  };
  input.addEventListener("input", show);
  queueMicrotask(show);
  return element("div", { className: "slider" }, element("label", { htmlFor: input.id }, slider.label), input, shown);
}

function clockOfSliders() {
  const values = Object.fromEntries(sliders.map((slider) => [slider.key, valueOf(slider)]));
  return { ...values, hasEvent: byId("has-event").checked };
}

// ---- simulate, fit, place on the map

const fileOf = (result, path) => result.files.find((made) => made.path === path)?.bytes;

function fail(result) {
  const place = byId("simulator-failure");
  place.textContent = result.err.split("\n").filter((line) => line.startsWith("goingrate:")).join(" ").replace("goingrate: ", "")
    || "the command failed";
  place.hidden = false;
}

async function run(words, files) {
  const result = await progress.run(words, files);
  if (result.code !== 0) fail(result);
  return result.code === 0 ? result : null;
}

const mapMargin = 5; // the map reaches from 1/5 of the clock's values to 5 times these

function mapWords(clock, mu) {
  const around = (value) => [String(value / mapMargin), String(Math.min(1, value * mapMargin))];
  return ["map", `--phi0=${clock.phi0}`, "--epsilon", ...around(clock.epsilon), "--mu", ...around(mu),
    "--solve", `epsilon=${clock.epsilon}`, `mu=${mu}`, "--plot=/out/map.svg", "-o", "/out/point.txt"];
}

async function simulateAndFit() {
  const clock = clockOfSliders();
  byId("simulator-failure").hidden = true;
  byId("simulated").hidden = true;
  byId("maps").replaceChildren();
  const scenario = { name: "clock.toml", bytes: new TextEncoder().encode(scenarioText(clock)) };
  const made = await run(["simulate", "clock.toml", "-o", "/out/log.csv", `--seed=${clock.seed}`], [scenario]);
  if (!made) return;
  log = { name: "simulated.csv", bytes: fileOf(made, "log.csv") };
  byId("simulated").hidden = false;
  byId("fit-table").replaceChildren();
  const maps = clock.hasEvent ? [clock.mu, clock.mu * clock.factor] : [clock.mu];
  for (const [i, mu] of maps.entries()) {
    const map = await run(mapWords(clock, mu), []);
    if (map) showMap(map, maps.length === 1 ? "The clock's place on the map" : `The clock's place ${i === 0 ? "before" : "after"} the change`);
  }
  const fit = await run(["fit", "simulated.csv", "--json=/out/fit.json"], [log]);
  if (fit) showFit(JSON.parse(textOf(fit, "fit.json")), clock);
}

function showMap(result, title) {
  const address = URL.createObjectURL(new Blob([fileOf(result, "map.svg")], { type: "image/svg+xml" }));
  const point = textOf(result, "point.txt")?.trim() ?? "";
  byId("maps").append(element("figure", {}, element("h3", {}, title),
    element("img", { src: address, alt: `Rate against friction, for some torques; the clock is marked. ${point}` }),
    element("pre", { tabIndex: 0 }, point)));
}

const symbols = { T0: "T0, s", epsilon: "friction ε", mu: "driving torque μ", phi0: "escapement angle φ0, rad",
  lambda0: "amplitude at the first beat λ0, rad", "mu@1": "driving torque μ after the change",
  jitter_rms: "scatter of the sensor's times, s", drive_rms: "fast noise of the drive, rms" };

function putIn(name, clock) {
  const known = { T0: clock.T0, epsilon: clock.epsilon, mu: clock.mu, phi0: clock.phi0, jitter_rms: clock.jitter,
    drive_rms: clock.fast, "mu@1": clock.hasEvent ? clock.mu * clock.factor : undefined };
  return known[name];
}

function showFit(fit, clock) {
  const rows = fit.parameters.map(({ name, value, sigma, status }) => {
    const truth = putIn(name, clock);
    const off = truth !== undefined && sigma > 0 ? `${((value - truth) / sigma).toFixed(1).replace("-", "−")} σ` : "";
    return [symbols[name] ?? name, truth === undefined ? "" : shortNumber(truth),
      status === "undetermined" ? "undetermined" : withSigma(value, sigma), off];
  });
  byId("fit-table").replaceChildren(table("True values and fitted values", ["quantity", "true", "fitted", "difference"], rows));
}

export function beginSimulator() {
  progress = new Progress(byId("simulator-progress"));
  byId("sliders").append(...sliders.filter((slider) => !slider.event).map(sliderRow));
  byId("event-sliders").append(...sliders.filter((slider) => slider.event).map(sliderRow));
  byId("has-event").addEventListener("change", () => { byId("scenario").textContent = scenarioText(clockOfSliders()); });
  byId("simulate").addEventListener("click", () => simulateAndFit().catch((error) => {
    if (!(error instanceof Cancelled)) fail({ err: `goingrate: ${error.message}` });
  }));
  byId("use-simulated").addEventListener("click", () => {
    location.hash = "#logs";
    useFiles([log]);
  });
}
