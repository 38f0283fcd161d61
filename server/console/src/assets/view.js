// Live view of a station: in three dimensions where the browser can, else flat.

import { Flat } from "./flat.js";

/** Least width of the window for three dimensions, CSS pixels. */
const WIDE = 900;
/** Age at which the viewer is loaded again: its memory grows with the stream, ms. */
const OLDEST = 30 * 60 * 1000;
/** Time without news from the viewer, while the session runs, after which it is loaded again, ms. */
const SILENT = 20 * 1000;

function canDraw() {
  const isPhone = /Android|iPhone|iPad|iPod|Mobile/i.test(navigator.userAgent);
  return !isPhone && typeof WebAssembly === "object" && document.createElement("canvas").getContext("webgl2") !== null;
}

/** The view in the element `place`. `told` shows a sentence about it. */
export class View {
  constructor(station, place, told, buttons) {
    Object.assign(this, { station, place, told, buttons });
    this.kind = "";
    this.status = null;
    this.frame = null;
    buttons.solid.addEventListener("click", () => this.show("solid"));
    buttons.flat.addEventListener("click", () => this.show("flat"));
    buttons.again.addEventListener("click", () => this.show(this.kind));
    window.addEventListener("message", (event) => this.hear(event));
    setInterval(() => this.look(), 1000);
    this.show(canDraw() && window.innerWidth >= WIDE ? "solid" : "flat");
  }

  /** Shows a kind of view. `why`: reason why it is not the other one, or empty. */
  show(kind, why = "") {
    this.flat?.close();
    this.flat = null;
    this.frame = null;
    this.kind = kind;
    this.place.dataset.kind = kind;
    for (const name of ["solid", "flat"]) {
      this.buttons[name].setAttribute("aria-pressed", String(name === kind));
    }
    this.place.replaceChildren();
    if (kind === "flat") {
      const tell = (text) => this.tell([text, why].filter(Boolean).join(" "));
      tell("");
      this.flat = new Flat(this.station, this.place, tell);
    } else {
      this.solid();
    }
  }

  tell(text) {
    if (this.told.textContent !== text) {
      this.told.textContent = text;
    }
  }

  /** Shows the flat view instead of the one in three dimensions, with the reason. */
  fall(why) {
    this.show("flat", `Flat view: ${why}`);
  }

  async solid() {
    if (!this.isRunning()) {
      this.tell("The view begins with the session.");
      return;
    }
    this.tell("loading the viewer");
    try {
      const answer = await fetch("/api/viewer", { cache: "no-store" });
      const said = await answer.json();
      if (this.kind !== "solid") {
        return;
      }
      if (!answer.ok) {
        this.fall(said.error);
        return;
      }
      const theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
      const frame = document.createElement("iframe");
      frame.title = `Live view of ${this.station} in three dimensions`;
      frame.src = `${said.page}?station=${encodeURIComponent(this.station)}&theme=${theme}`;
      this.frame = frame;
      this.began = this.heard = performance.now();
      this.place.replaceChildren(frame);
    } catch (error) {
      this.fall(String(error.message));
    }
  }

  hear(event) {
    const isOwn = event.origin === location.origin && this.frame && event.source === this.frame.contentWindow;
    if (!isOwn || event.data?.from !== "sulcus-viewer") {
      return;
    }
    if (event.data.failed) {
      this.fall(event.data.failed);
    } else if (event.data.started) {
      this.heard = performance.now();
      this.tell("");
    } else if (event.data.seconds !== this.seconds) {
      this.seconds = event.data.seconds;
      this.place.dataset.seconds = this.seconds;
      this.heard = performance.now();
    }
  }

  isRunning() {
    return ["running", "waiting"].includes(this.status?.phase);
  }

  /** Takes the newest status of the station. */
  take(status) {
    const isOther = this.status?.recording !== status.recording;
    const wasRunning = this.isRunning();
    this.status = status;
    if (this.kind === "solid" && (isOther || wasRunning !== this.isRunning())) {
      this.show("solid");
    }
  }

  look() {
    if (this.kind !== "solid" || !this.frame || document.visibilityState !== "visible") {
      return;
    }
    const now = performance.now();
    const isSilent = this.status?.phase === "running" && !this.status.paused && now - this.heard > SILENT;
    const isLoaded = this.place.dataset.seconds !== undefined;
    if (now - this.began > OLDEST || (isSilent && isLoaded)) {
      delete this.place.dataset.seconds;
      this.show("solid");
    }
  }
}
