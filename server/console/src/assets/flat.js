// Flat picture of a station: from the side of the probed tooth, and from above. Texts go through `textContent` alone.

const SVG = "http://www.w3.org/2000/svg";
/** Half of the width of a picture near a tool, and of the whole mouth, mm. */
const NEAR = 22;
const WHOLE = 45;
/** Length of a force arrow for one newton, mm. */
const ARROW = 20;
/** Least force that is drawn, N, and least distance of the hand from the tool, mm. */
const LEAST = 0.005;
const APART = 0.1;
/** Share of the way to a new place that a picture moves at once. */
const SOON = 0.25;
/** Interval between two texts, ms. */
const TEXT = 500;

export const SITES = ["mesiobuccal", "buccal", "distobuccal", "distolingual", "lingual", "mesiolingual"];
const ZONES = ["light", "too heavy", "trauma", "damage"];

function drawn(name, attributes, children = []) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

const minus = (a, b) => a.map((x, k) => x - b[k]);
const plus = (a, b, scale = 1) => a.map((x, k) => x + scale * b[k]);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const size = (a) => Math.hypot(...a);
const middle = (list) => [0, 1, 2].map((k) => list.reduce((sum, at) => sum + at[k], 0) / list.length);

/** Convex hull of points in the plane. */
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const kept = [];
    for (const at of list) {
      while (kept.length > 1) {
        const [a, b] = kept.slice(-2);
        if ((b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]) > 0) {
          break;
        }
        kept.pop();
      }
      kept.push(at);
    }
    return kept.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** The part of a convex area within a square about the middle. */
function inside(points, half) {
  let kept = points;
  for (const [axis, sign] of [
    [0, 1],
    [0, -1],
    [1, 1],
    [1, -1],
  ]) {
    const left = kept;
    kept = [];
    left.forEach((at, k) => {
      const before = left.at(k - 1);
      const [a, b] = [before, at].map((point) => half - sign * point[axis]);
      if (a < 0 !== b < 0) {
        const share = a / (a - b);
        kept.push(before.map((x, i) => x + share * (at[i] - x)));
      }
      if (b >= 0) {
        kept.push(at);
      }
    });
  }
  return kept;
}

/** The part of a segment within a square about the middle, or nothing. */
function within([from, to], half) {
  let [begin, end] = [0, 1];
  for (const axis of [0, 1]) {
    const by = to[axis] - from[axis];
    for (const sign of [1, -1]) {
      const [left, step] = [half - sign * from[axis], sign * by];
      if (step === 0 && left < 0) {
        return null;
      }
      if (step > 0) {
        end = Math.min(end, left / step);
      } else if (step < 0) {
        begin = Math.max(begin, left / step);
      }
    }
  }
  const at = (share) => from.map((x, k) => x + share * (to[k] - x));
  return begin < end ? [at(begin), at(end)] : null;
}

/** Path of a line within a square about the middle. */
const line = (points, half) =>
  points
    .slice(1)
    .map((to, k) => within([points[k], to], half))
    .filter((part) => part !== null)
    .map((part) => path(part, false))
    .join("");

const path = (points, isClosed) =>
  points.length > 0 ? `M${points.map((at) => `${at[0].toFixed(2)} ${at[1].toFixed(2)}`).join("L")}${isClosed ? "z" : ""}` : "";

/** A picture: direction of the eye, of the right, of down. */
class Picture {
  constructor(title) {
    this.title = title;
    this.svg = drawn("svg", { class: "flat", role: "img" });
    const caption = document.createElement("figcaption");
    caption.textContent = title;
    this.figure = document.createElement("figure");
    this.figure.append(caption, this.svg);
  }

  draw({ eye, right, down }, focus, half, teeth, tools, text) {
    const flat = (at) => {
      const from = minus(at, focus);
      return [dot(from, right), dot(from, down)];
    };
    // Parts outside are cut off: a browser counts them to the size of the page.
    const isShown = (at) => Math.max(Math.abs(at[0]), Math.abs(at[1])) < half - 1;
    const near = teeth.filter((tooth) => size(minus(tooth.middle, focus)) < half + 12);
    near.sort((a, b) => dot(a.middle, eye) - dot(b.middle, eye));
    const parts = [];
    for (const tooth of near) {
      const margin = tooth.margin.map(flat);
      parts.push(
        drawn("path", { class: "tooth", d: path(inside(hull(tooth.points.map(flat)), half), true) }),
        drawn("path", { class: "margin", d: line([...margin, ...margin.slice(0, 1)], half) }),
      );
      const at = flat(tooth.middle);
      if (isShown(at)) {
        const label = drawn("text", { class: "number", x: at[0].toFixed(2), y: (at[1] + 1).toFixed(2) });
        label.textContent = tooth.fdi;
        parts.push(label);
      }
    }
    tools.forEach((tool, k) => {
      if (!tool.held) {
        return;
      }
      const shape = tool.line.map(flat);
      const tip = shape.at(-1);
      parts.push(
        drawn("path", { class: `rim tool${k}`, d: path(inside(tool.rim.map(flat), half), true) }),
        drawn("path", { class: `tool tool${k}`, d: line(shape, half) }),
      );
      if (!isShown(tip)) {
        return;
      }
      parts.push(drawn("circle", { class: `tip tool${k}`, cx: tip[0].toFixed(2), cy: tip[1].toFixed(2), r: 0.5 }));
      const world = tool.line.at(-1);
      if (size(minus(tool.hand, world)) > APART) {
        const hand = flat(tool.hand);
        parts.push(
          drawn("path", { class: "apart", d: line([tip, hand], half) }),
          drawn("circle", { class: "hand", cx: hand[0].toFixed(2), cy: hand[1].toFixed(2), r: isShown(hand) ? 0.7 : 0 }),
        );
      }
      if (size(tool.force_n) > LEAST) {
        const to = flat(plus(world, tool.force_n, ARROW));
        parts.push(drawn("path", { class: "force", d: line([tip, to], half), "marker-end": "url(#arrow)" }));
      }
    });
    this.svg.setAttribute("viewBox", `${-half} ${-half} ${2 * half} ${2 * half}`);
    this.svg.setAttribute("aria-label", `${this.title}. ${text}`);
    this.svg.replaceChildren(arrow(), ...parts);
  }
}

function arrow() {
  const head = drawn("path", { class: "head", d: "M0 0L4 2L0 4z" });
  const marker = { id: "arrow", markerWidth: 4, markerHeight: 4, refX: 3, refY: 2, orient: "auto", markerUnits: "strokeWidth" };
  return drawn("defs", {}, [drawn("marker", marker, [head])]);
}

/** Sentence about an instant. */
function words(names, frame) {
  const parts = frame.tools.map((tool, k) => {
    const name = names[k] ?? `tool ${k + 1}`;
    if (!tool.held) {
      return `${name} not held`;
    }
    const force = `force ${size(tool.force_n).toFixed(2)} N`;
    if (!tool.pocket) {
      return `${name}: ${force}`;
    }
    const { tooth, site, depth_mm, true_depth_mm, floor_n, zone } = tool.pocket;
    const depth = `depth ${depth_mm.toFixed(1)} of ${true_depth_mm.toFixed(1)} mm`;
    return `${name} at ${tooth} ${SITES[site]}: ${depth}, ${floor_n.toFixed(2)} N on the floor, ${ZONES[zone]}, ${force}`;
  });
  return `${parts.join("; ")}${frame.paused ? "; paused" : ""}`;
}

/** The flat view in an element. `tell` takes a sentence. */
export class Flat {
  constructor(station, place, tell) {
    this.tell = tell;
    this.side = new Picture("From the side of the tooth");
    this.top = new Picture("From above");
    this.text = document.createElement("p");
    this.text.className = "flat-text";
    const pictures = document.createElement("div");
    pictures.className = "flats";
    pictures.append(this.side.figure, this.top.figure);
    place.replaceChildren(pictures, this.text);
    this.place = place;
    this.mouth = null;
    this.open(`/api/stations/${encodeURIComponent(station)}/flat`);
  }

  open(address) {
    this.source = new EventSource(address);
    this.source.addEventListener("none", () => {
      this.mouth = null;
      this.tell("The view begins with the session.");
    });
    this.source.addEventListener("mouth", (message) => {
      this.mouth = JSON.parse(message.data);
      this.focus = null;
      for (const tooth of this.mouth.teeth) {
        tooth.middle = middle(tooth.points);
      }
      const all = this.mouth.teeth.map((tooth) => tooth.middle);
      this.middle = all.length > 0 ? middle(all) : [0, 0, 0];
      this.tell("");
      const tools = this.mouth.tools.map(() => ({ held: false, line: [], rim: [], hand: [0, 0, 0], force_n: [0, 0, 0], pocket: null }));
      this.draw({ tools, paused: false });
    });
    this.source.addEventListener("frame", (message) => {
      if (this.mouth) {
        const frame = JSON.parse(message.data);
        this.place.dataset.tick = frame.tick;
        this.draw(frame);
      }
    });
    this.source.addEventListener("signed-out", () => {
      this.close();
      location.assign("/sign-in");
    });
    this.source.onerror = () => {
      if (this.source.readyState === EventSource.CLOSED) {
        this.again = setTimeout(() => this.open(address), 3000);
      }
    };
  }

  close() {
    clearTimeout(this.again);
    this.source.close();
  }

  draw(frame) {
    // The probe leads; a mirror shows when it is alone.
    const held = frame.tools.filter((tool) => tool.held);
    const leads = held.find((tool) => tool.rim.length === 0) ?? held[0];
    const pocket = leads?.pocket;
    const tooth = pocket && this.mouth.teeth.find((tooth) => tooth.fdi === pocket.tooth);
    const wanted = leads ? leads.line.at(-1) : this.middle;
    this.focus = this.focus ? plus(this.focus, minus(wanted, this.focus), SOON) : wanted;
    const out = minus(tooth?.middle ?? wanted, this.middle);
    let bearing = Math.hypot(out[0], out[1]) > 1 ? Math.atan2(out[1], out[0]) : 0;
    if (tooth && dot(minus(wanted, tooth.middle), [out[0], out[1], 0]) < 0) {
      bearing += Math.PI;
    }
    const turn = this.bearing === undefined ? 0 : Math.atan2(Math.sin(bearing - this.bearing), Math.cos(bearing - this.bearing));
    this.bearing = this.bearing === undefined ? bearing : this.bearing + SOON * turn;
    const eye = [Math.cos(this.bearing), Math.sin(this.bearing), 0];
    const half = leads ? NEAR : WHOLE;
    const text = words(this.mouth.tools, frame);
    const side = { eye, right: [-eye[1], eye[0], 0], down: [0, 0, -1] };
    // The patient's right is on the left, the front below.
    const top = { eye: [0, 0, 1], right: [0, 1, 0], down: [1, 0, 0] };
    this.side.draw(side, this.focus, half, this.mouth.teeth, frame.tools, text);
    this.top.draw(top, this.focus, half, this.mouth.teeth, frame.tools, text);
    const now = performance.now();
    if (!(now - this.said < TEXT)) {
      this.said = now;
      this.text.textContent = text;
    }
  }
}
