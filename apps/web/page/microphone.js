// Listens to a clock with the microphone: every few seconds the command analyses the last minute.
import { Cancelled, start, textOf } from "./engine.js";
import { byId, saveLink, table } from "./elements.js";
import { useFiles } from "./logs.js";
import { withSigma } from "./numbers.js";
import { wavOf } from "./sound.js";

const window_s = 60; // length of sound that is analysed each time
const least_s = 8; // length of sound before the first reading
const pause_s = 4; // between readings
const longest_s = 3600; // longest recording
const piece_samples = 16384; // the most that createScriptProcessor allows

let recording = null; // {stream, context, pieces, samples, rate}
let recorded = null; // the last recording, as WAV

const tell = (text) => { byId("microphone-says").textContent = text; };

const reasons = {
  NotFoundError: "There is no microphone here.",
  NotAllowedError: "This page is not allowed to use the microphone. Allow it in the browser's settings for this page, then start again.",
  NotReadableError: "Another program is using the microphone.",
};

function lastSeconds({ pieces, rate }, seconds) {
  let wanted = Math.round(seconds * rate), from = pieces.length;
  while (from > 0 && wanted > 0) wanted -= pieces[--from].length;
  return pieces.slice(from);
}

function keep(piece) {
  recording.pieces.push(piece);
  recording.samples += piece.length;
  if (recording.samples > longest_s * recording.rate) stop();
}

async function open() {
  // Processing that makes speech clearer suppresses ticks.
  const raw = { echoCancellation: false, noiseSuppression: false, autoGainControl: false };
  const stream = await navigator.mediaDevices.getUserMedia({ audio: raw });
  const context = new AudioContext();
  // An audio worklet would have to load a script by its address, which a page opened from a disk cannot do. The
  // pieces are so long that the page may be busy for a third of a second without losing one.
  const node = context.createScriptProcessor(piece_samples, 1, 1);
  node.onaudioprocess = ({ inputBuffer }) => { if (recording) keep(inputBuffer.getChannelData(0).slice()); };
  context.createMediaStreamSource(stream).connect(node).connect(context.destination); // without an output it would not run; it plays silence
  recording = { stream, context, pieces: [], samples: 0, rate: context.sampleRate };
}

function showReading(rate) {
  const perDay = withSigma(rate.rate_s_per_day, rate.rate_sigma_s_per_day);
  const beatError = rate.beat_error_s ? `${withSigma(1e3 * rate.beat_error_s.value, 1e3 * rate.beat_error_s.sigma)} ms` : "not heard";
  byId("reading").replaceChildren(table("What is heard", ["quantity", "value"], [
    ["period of the oscillation", `${rate.mean_period_s.toFixed(6)} s`],
    ["beats per hour", String(Math.round(7200 / rate.mean_period_s))],
    ["rate against the nominal period", `${perDay} s/day`],
    ["beat error, tick − tock", beatError],
    ["beats heard", String(rate.crossings)],
  ]));
}

async function read() {
  const own = recording;
  const period = byId("microphone-period").value.trim();
  const file = { name: "microphone.wav", bytes: wavOf(lastSeconds(own, window_s), own.rate) };
  const words = ["rate", file.name, "--json=/out/rate.json", "-o", "/out/rates.csv", ...(period ? [`--nominal-period=${period}`] : [])];
  const result = await start(words, [file]).result;
  if (recording !== own) return;
  if (result.code === 0) showReading(JSON.parse(textOf(result, "rate.json")));
  const error = result.err.split("\n").find((line) => line.startsWith("goingrate:"));
  tell(result.code === 0 ? "Listening. The numbers are for the last minute."
    : `Listening. No clock is heard yet: ${error?.replace(/^goingrate: (\S+: )?/, "") ?? ""}`);
}

async function listen() {
  const own = recording;
  while (recording === own) {
    const heard = own.samples / own.rate;
    if (heard >= least_s) await read();
    else tell(`Listening: ${Math.floor(heard)} s of the first ${least_s} s.`);
    await new Promise((done) => setTimeout(done, heard >= least_s ? 1000 * pause_s : 500));
  }
}

async function begin() {
  byId("recorded").hidden = true;
  byId("reading").replaceChildren();
  if (!navigator.mediaDevices?.getUserMedia) return tell("This browser does not let a page use the microphone.");
  tell("Waiting for the microphone.");
  try {
    await open();
  } catch (error) {
    return tell(reasons[error.name] ?? `The microphone cannot be used: ${error.message}`);
  }
  byId("listen").disabled = true;
  byId("stop-listening").disabled = false;
  byId("stop-listening").focus();
  return listen().catch((error) => { if (!(error instanceof Cancelled)) tell(error.message); });
}

function stop() {
  if (!recording) return;
  for (const track of recording.stream.getTracks()) track.stop();
  recording.context.close();
  recorded = { name: "microphone.wav", bytes: wavOf(recording.pieces, recording.rate) };
  const seconds = recording.samples / recording.rate;
  recording = null;
  byId("listen").disabled = false;
  byId("stop-listening").disabled = true;
  byId("recorded").hidden = seconds === 0;
  byId("save-recording").replaceChildren(saveLink(recorded.name, recorded.bytes, "audio/wav"));
  tell(`Stopped after ${seconds.toFixed(0)} s.`);
}

export function beginMicrophone() {
  byId("listen").addEventListener("click", begin);
  byId("stop-listening").addEventListener("click", stop);
  byId("use-recording").addEventListener("click", () => {
    location.hash = "#logs";
    useFiles([recorded]);
  });
}
