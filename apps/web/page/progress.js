// The line that names the step under way, with the button that cancels the run. One run at a time.
import { Cancelled, start } from "./engine.js";

/** Updates the elements of one progress line; onCancelled is called when the reader has cancelled. */
export class Progress {
  constructor(place) {
    this.words = place.querySelector(".stage");
    this.bar = place.querySelector("progress");
    this.button = place.querySelector("button");
    this.place = place;
    this.current = null;
    this.button.addEventListener("click", () => this.current?.cancel());
  }

  #tell(stage, share) {
    this.stage = stage;
    if (share >= 0) this.bar.value = share;
    else this.bar.removeAttribute("value");
    this.#draw();
  }

  #draw() {
    const seconds = Math.floor((performance.now() - this.began) / 1000);
    this.words.textContent = seconds > 0 ? `${this.stage} ... ${seconds} s` : this.stage;
  }

  /** Runs the command like engine.start, after cancelling a run that is still under way. */
  async run(words, files) {
    this.current?.cancel();
    const own = start(words, files, (stage, share) => { if (this.current === own) this.#tell(stage, share); });
    this.current = own;
    this.began = performance.now();
    this.place.hidden = false;
    this.#tell("starting", -1);
    const clock = setInterval(() => this.#draw(), 1000);
    try {
      return await own.result;
    } catch (error) {
      if (error instanceof Cancelled && this.current === own) this.onCancelled?.();
      throw error;
    } finally {
      clearInterval(clock);
      if (this.current === own) {
        this.current = null;
        this.place.hidden = true;
      }
    }
  }
}
