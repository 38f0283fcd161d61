// Tile of a station. Texts go through `textContent` alone: names and notes come from others.

import { instruct } from "./live.js";

const SVG = "http://www.w3.org/2000/svg";
/** Number of samples of the force's trace: 24 s. */
const SAMPLES = 120;
/** Name of each zone of force, lightest first. */
const ZONES = ["light", "too heavy", "trauma", "damage"];
const PHASES = {
  free: "free",
  ready: "ready to start",
  running: "running",
  waiting: "student away",
  ending: "recording is being signed",
};
const MARKS = { alarm: "⚠ ", warning: "▲ ", notice: "● ", none: "" };

function made(name, properties = {}, children = []) {
  const element = document.createElement(name);
  Object.assign(element, properties);
  element.append(...children);
  return element;
}

function drawn(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, value);
  }
  return element;
}

/** `m:ss`. */
function clock(ms) {
  const s = Math.floor(ms / 1000);
  return `${Math.floor(s / 60)}:${String(s % 60).padStart(2, "0")}`;
}

/** One tile. `isOnly`: the page shows this station alone. */
export class Tile {
  constructor(name, isOnly) {
    this.name = name;
    this.samples = [];
    this.element = made("article", { className: "tile", tabIndex: isOnly ? -1 : 0 });
    this.element.dataset.station = name;
    const title = isOnly
      ? made("span", { textContent: name })
      : made("a", { href: `/stations/${encodeURIComponent(name)}`, textContent: name });
    this.phase = made("span", { className: "phase" });
    this.learner = made("span", { className: "learner" });
    this.exercise = made("span", { className: "exercise" });
    this.time = made("span", { className: "time" });
    this.alerts = made("ul", { className: "alerts" });
    this.alerts.setAttribute("aria-label", "Alerts");
    this.trace = drawn("svg", { class: "trace", viewBox: "0 0 240 60", preserveAspectRatio: "none", role: "img" });
    this.bars = ZONES.map((_, zone) => drawn("path", { class: `zone${zone}`, d: "" }));
    this.trace.append(...this.bars);
    this.values = {};
    const list = made("dl", { className: "values" });
    for (const [key, label] of [
      ["site", "Site"],
      ["force", "Force, N"],
      ["depth", "Depth, mm"],
      ["called", "Called"],
      ["link", "Pose age, ms"],
      ["limit", "Limit, N"],
    ]) {
      this.values[key] = made("dd", { textContent: "–" });
      list.append(made("div", {}, [made("dt", { textContent: label }), this.values[key]]));
    }
    this.pause = made("button", { type: "button", className: "pause", textContent: "Pause" });
    this.pause.addEventListener("click", () => this.toggle());
    this.answer = made("p", { className: "answer" });
    this.answer.setAttribute("role", "status");
    this.element.addEventListener("keydown", (event) => {
      if (event.target === this.element && event.key === "p") {
        this.toggle();
      }
    });
    this.element.append(
      made("h2", {}, [title, " ", this.phase]),
      made("p", { className: "about" }, [this.learner, this.exercise, this.time]),
      this.alerts,
      this.trace,
      list,
      this.pause,
      this.answer,
    );
  }

  async toggle() {
    if (!this.data || this.pause.disabled) {
      return;
    }
    const isPaused = this.data.status.paused;
    this.pause.disabled = true;
    const told = await instruct(this.name, { do: isPaused ? "resume" : "pause" });
    this.pause.disabled = false;
    this.tell(`${isPaused ? "Resume" : "Pause"} ${told.text}`, told);
  }

  tell(text, told) {
    this.answer.textContent = text;
    this.answer.dataset.tick = told.tick;
    this.answer.classList.toggle("problem", !told.ok);
  }

  /** Takes the newest data of the station. */
  take(data) {
    this.data = data;
    const { name, status, alerts, urgency, called } = data;
    this.element.dataset.urgency = urgency;
    this.element.dataset.phase = status.phase;
    this.element.dataset.tick = status.tick;
    this.phase.textContent = status.paused ? "paused" : PHASES[status.phase];
    this.phase.dataset.phase = status.paused ? "paused" : status.phase;
    const person = name ? `${name} (${status.learner})` : status.learner || "anonymous";
    this.learner.textContent = status.phase === "free" ? "" : person;
    this.exercise.textContent = [status.exercise, status.mode].filter(Boolean).join(", ");
    this.time.textContent = status.recording ? clock(status.elapsed_ms) : "";
    this.alerts.replaceChildren(
      ...alerts.map((alert) => {
        const item = made("li", { textContent: `${MARKS[alert.urgency]}${alert.text}` });
        item.dataset.urgency = alert.urgency;
        item.dataset.kind = alert.kind;
        return item;
      }),
    );
    const held = status.tools.filter((tool) => tool.present);
    const probing = status.tools.find((tool) => tool.tooth > 0);
    const force = Math.max(0, ...held.map((tool) => tool.force_n));
    const say = (key, text) => {
      this.values[key].textContent = text || "–";
    };
    say("site", probing ? `${probing.tooth} ${probing.site}` : "");
    const zone = probing ? `, ${ZONES[probing.zone]}` : "";
    say("force", held.length > 0 ? `${force.toFixed(2)}${zone}` : "");
    say("depth", probing ? `${probing.depth_mm.toFixed(1)} of ${probing.true_depth_mm.toFixed(1)}` : "");
    say("called", called ? `${called.tooth} ${called.site}: ${called.depth_mm} mm` : "");
    // With ticks at the hand the force is not delayed, but the recording and this page are.
    const behind = status.behind_ms;
    const ages = held.map((tool) => tool.pose_age_ms).join(" / ");
    say("link", Number.isFinite(behind) ? `hand, ${behind} behind` : ages);
    say("limit", status.force_limit_n > 0 ? status.force_limit_n.toFixed(1) : "scene's");
    this.pause.textContent = status.paused ? "Resume" : "Pause";
    this.pause.setAttribute("aria-label", `${this.pause.textContent} ${this.name}`);
    this.sample(status);
  }

  /** Adds a sample to the trace: the largest force since the previous status, and its zone. */
  sample(status) {
    if (this.recording !== status.recording) {
      this.recording = status.recording;
      this.samples = [];
    }
    if (this.tick === status.tick) {
      return;
    }
    this.tick = status.tick;
    const peaks = status.tools.map((tool) => tool.peak_force_n);
    const zones = status.tools.map((tool) => tool.peak_zone);
    this.samples.push({ force: Math.max(...peaks), zone: Math.max(...zones) });
    if (this.samples.length > SAMPLES) {
      this.samples.shift();
    }
    this.draw();
  }

  draw() {
    const largest = Math.max(0.5, ...this.samples.map((sample) => sample.force));
    const top = Math.ceil(2 * largest) / 2;
    const x = (k) => (240 * (k + SAMPLES - this.samples.length)) / (SAMPLES - 1);
    const y = (force) => 58 - (56 * force) / top;
    // One path for each zone: thirty stations with a hundred bars each would keep a tablet busy.
    const bars = ["", "", "", ""];
    this.samples.forEach((sample, k) => {
      const height = Math.max(58 - y(sample.force), 0.6).toFixed(1);
      bars[sample.zone] += `M${(x(k) - 2).toFixed(1)} 58v-${height}h1.6v${height}z`;
    });
    bars.forEach((path, zone) => this.bars[zone].setAttribute("d", path));
    const heavy = this.samples.filter((sample) => sample.zone > 0).length;
    const text = `Force of the last 24 s, scale ${top} N, ${heavy} of ${this.samples.length} samples too heavy`;
    this.trace.setAttribute("aria-label", text);
    this.trace.dataset.top = top;
  }
}
