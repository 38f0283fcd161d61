// Force and depth of the last minute, from the station's statuses.

const SVG = "http://www.w3.org/2000/svg";
/** Time that is shown, seconds. */
const SHOWN = 60;
const WIDTH = 300;
const HEIGHT = 70;

function drawn(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, value);
  }
  return element;
}

/** One plot with lines of the given classes. */
class Plot {
  constructor(title, unit, lines) {
    this.title = title;
    this.unit = unit;
    this.svg = drawn("svg", { class: "plot", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img" });
    this.lines = lines.map((name) => drawn("path", { class: `line ${name}`, d: "" }));
    this.svg.append(...this.lines);
    this.caption = document.createElement("figcaption");
    this.figure = document.createElement("figure");
    this.figure.append(this.caption, this.svg);
  }

  /** Draws samples `{ s, values }`; a `null` is a gap. `least`: least value at the top of the scale. */
  draw(samples, least) {
    const all = samples.flatMap((sample) => sample.values).filter((value) => value !== null);
    const top = Math.ceil(2 * Math.max(least, ...all)) / 2;
    const end = samples.at(-1)?.s ?? 0;
    this.lines.forEach((line, k) => {
      let isDrawn = false;
      const parts = samples.map(({ s, values }) => {
        const value = values[k];
        if (value === null) {
          isDrawn = false;
          return "";
        }
        const x = WIDTH * (1 - (end - s) / SHOWN);
        const y = HEIGHT - 1 - ((HEIGHT - 2) * Math.max(0, value)) / top;
        const part = `${isDrawn ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`;
        isDrawn = true;
        return part;
      });
      line.setAttribute("d", parts.join(""));
    });
    const largest = all.length > 0 ? Math.max(...all).toFixed(2) : "none";
    const text = `${this.title}, last ${SHOWN} s: scale 0 to ${top} ${this.unit}, largest ${largest}`;
    this.caption.textContent = text;
    this.svg.setAttribute("aria-label", text);
  }
}

export class Plots {
  constructor(place) {
    this.force = new Plot("Force on the hand, and on the pocket's floor (dashed)", "N", ["first", "second"]);
    this.depth = new Plot("Depth of the tip, and of the site by the scene (dashed)", "mm", ["first", "second"]);
    place.append(this.force.figure, this.depth.figure);
    this.samples = [];
    this.draw();
  }

  /** Takes the newest status of the station. */
  take(status) {
    if (this.recording !== status.recording) {
      this.recording = status.recording;
      this.samples = [];
    }
    if (!status.recording || this.samples.at(-1)?.tick === status.tick) {
      return;
    }
    const s = status.tick / Math.max(status.rate_hz, 1);
    const held = status.tools.filter((tool) => tool.present);
    const probing = status.tools.find((tool) => tool.tooth > 0);
    this.samples.push({
      tick: status.tick,
      s,
      force: [held.length > 0 ? Math.max(...held.map((tool) => tool.peak_force_n)) : null, probing?.floor_force_n ?? null],
      depth: [probing?.depth_mm ?? null, probing?.true_depth_mm ?? null],
    });
    while (this.samples[0].s < s - SHOWN) {
      this.samples.shift();
    }
    this.draw();
  }

  draw() {
    const of = (key) => this.samples.map((sample) => ({ s: sample.s, values: sample[key] }));
    this.force.draw(of("force"), 0.5);
    this.depth.draw(of("depth"), 5);
  }
}
