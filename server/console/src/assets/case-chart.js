// The chart of a jaw: teeth with their six sites, margin and attachment as lines.

import { make } from "./ask.js";

const SVG = "http://www.w3.org/2000/svg";
export const SIDES = ["lingual", "buccal"];
/** Names of the three sites of a side. */
const PLACES = ["mesio", "mid-", "disto"];
/** Depth of a pocket, and of a deep one, mm. */
const POCKET_MM = 4;
const DEEP_MM = 6;
/** Picture of a side, mm: width, height over the CEJ, depth below the CEJ. */
const WIDE = 30;
const CROWN = 8;
const ROOT = 13;

/** Number of a tooth: FDI, or Universal (32 is the lower right third molar). */
export function numbered(fdi, isUniversal) {
  if (!isUniversal) {
    return String(fdi);
  }
  const place = fdi % 10;
  const number = { 1: 9 - place, 2: 8 + place, 3: 25 - place, 4: 24 + place }[Math.floor(fdi / 10)];
  return String(number);
}

/** Name of a site for people. */
export function siteName(side, k) {
  return k === 1 ? side : `${PLACES[k]}${side}`;
}

export function isMolar(fdi) {
  return fdi % 10 >= 6;
}

/** Whether the mesial end is on the left of the page: the left half of a jaw. */
function mesialFirst(fdi) {
  const quadrant = Math.floor(fdi / 10);
  return quadrant === 2 || quadrant === 3;
}

/** Places of a side from left to right on the page. */
export function order(fdi) {
  return mesialFirst(fdi) ? [0, 1, 2] : [2, 1, 0];
}

function element(kind, attributes) {
  const made = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) {
    made.setAttribute(name, value);
  }
  return made;
}

/** Outline of a tooth from its side; y points to the root, 0 is the CEJ. */
function outline(fdi) {
  const place = fdi % 10;
  if (place >= 6) {
    return "M6,0 C3,-3 3,-6 5,-7 C8,-8 10,-6 12,-7 C14,-8 16,-8 18,-7 C20,-6 22,-8 25,-7 C27,-6 27,-3 24,0 C25,5 24,10 22,12 C19,11 18,8 17,5 C16,4 14,4 13,5 C12,8 11,11 8,12 C6,10 5,5 6,0 Z";
  }
  if (place >= 4) {
    return "M9,0 C7,-3 8,-6 11,-7 C13,-8 17,-8 19,-7 C22,-6 23,-3 21,0 C21,5 18,11 15,12 C12,11 9,5 9,0 Z";
  }
  if (place === 3) {
    return "M9,0 C8,-4 9,-6 15,-8 C21,-6 22,-4 21,0 C21,5 18,12 15,13 C12,12 9,5 9,0 Z";
  }
  return "M10,0 C9,-3 9,-6 10,-7.5 L20,-7.5 C21,-6 21,-3 20,0 C20,5 17,10 15,11 C13,10 10,5 10,0 Z";
}

/** A site of the chart. */
class Site {
  constructor(fdi, side, k, onSelect) {
    this.button = make("button", "site");
    this.button.type = "button";
    this.button.tabIndex = -1;
    Object.assign(this.button.dataset, { fdi, side, place: k });
    this.depth = make("span", "depth");
    this.margin = make("span", "edge");
    this.dot = make("span", "dot");
    this.button.append(...(side === "lingual" ? [this.dot, this.margin, this.depth] : [this.depth, this.margin, this.dot]));
    this.button.addEventListener("click", () => onSelect({ fdi, side, place: k }));
  }

  show(tooth, side, k, name, fault) {
    const depth = tooth.depth_mm[side][k];
    const margin = tooth.recession_mm[side][k];
    const bleeds = tooth.bleeding[side][k];
    this.depth.textContent = String(depth);
    this.margin.textContent = margin > 0 ? `+${margin}` : String(margin).replace("-", "−");
    this.dot.textContent = fault ? "!" : bleeds ? "●" : "";
    const list = this.button.classList;
    list.toggle("pocket", depth >= POCKET_MM);
    list.toggle("deep", depth >= DEEP_MM);
    list.toggle("fault", Boolean(fault));
    const words = `${name}, ${siteName(side, k)}: depth ${depth} mm, margin ${margin} mm${bleeds ? ", bleeds" : ""}${fault ? `. ${fault}` : ""}`;
    this.button.setAttribute("aria-label", words);
    this.button.title = words;
  }
}

/** A side of a tooth: outline with margin and attachment. */
class Picture {
  constructor(fdi, side) {
    this.fdi = fdi;
    // Crowns of the two sides face each other: lingual roots point up.
    const isUp = side === "lingual";
    const top = isUp ? -ROOT : -CROWN;
    this.svg = element("svg", { viewBox: `0 ${top} ${WIDE} ${CROWN + ROOT}`, class: "side", "aria-hidden": "true" });
    this.group = element("g", isUp ? { transform: "scale(1 -1)" } : {});
    this.tooth = element("path", { d: outline(fdi), class: "tooth" });
    this.cej = element("line", { x1: 1, x2: WIDE - 1, y1: 0, y2: 0, class: "cej" });
    this.pocket = element("polygon", { class: "pocket" });
    this.margin = element("polyline", { class: "margin" });
    this.floor = element("polyline", { class: "floor" });
    this.fork = element("text", { class: "fork", x: WIDE / 2, "text-anchor": "middle" });
    this.group.append(this.tooth, this.cej, this.pocket, this.margin, this.floor);
    this.svg.append(this.group, this.fork);
    this.fork.setAttribute("y", isUp ? -6 : 8.5);
  }

  show(tooth, side) {
    const at = order(this.fdi).map((k, n) => {
      const margin = Math.max(-CROWN, Math.min(ROOT, tooth.recession_mm[side][k]));
      const floor = Math.max(-CROWN, Math.min(ROOT, margin + tooth.depth_mm[side][k]));
      return { x: 4 + 11 * n, margin, floor };
    });
    const points = (key) => at.map((one) => `${one.x},${one[key]}`);
    this.margin.setAttribute("points", points("margin").join(" "));
    this.floor.setAttribute("points", points("floor").join(" "));
    this.pocket.setAttribute("points", [...points("margin"), ...points("floor").reverse()].join(" "));
    const degree = tooth.furcation[side === "buccal" ? 0 : 1];
    this.fork.textContent = degree > 0 ? ["", "○", "◐", "●"][degree] ?? "?" : "";
  }
}

/** A tooth of the chart. */
class Column {
  constructor(fdi, onSelect, onTooth) {
    this.fdi = fdi;
    this.element = make("div", "column");
    this.element.dataset.fdi = fdi;
    this.head = make("button", "head");
    this.head.type = "button";
    this.head.tabIndex = -1;
    this.head.addEventListener("click", () => onTooth(fdi));
    this.sites = {};
    this.pictures = {};
    const rows = {};
    for (const side of SIDES) {
      rows[side] = make("div", "sites");
      this.sites[side] = [];
      for (const k of order(fdi)) {
        const site = new Site(fdi, side, k, onSelect);
        this.sites[side][k] = site;
        rows[side].append(site.button);
      }
      this.pictures[side] = new Picture(fdi, side);
    }
    this.element.append(rows.lingual, this.pictures.lingual.svg, this.head, this.pictures.buccal.svg, rows.buccal);
  }

  show(tooth, name, faults, isMissing) {
    this.element.classList.toggle("missing", isMissing);
    const own = faults.filter((fault) => fault.fdi === this.fdi);
    const whole = own.filter((fault) => !fault.site);
    this.head.textContent = isMissing ? `${name} ✕` : whole.length > 0 ? `${name} !` : name;
    this.head.classList.toggle("fault", whole.length > 0);
    const about = whole.map((fault) => fault.text).join(". ");
    this.head.setAttribute("aria-label", `Tooth ${name}${isMissing ? ", missing" : ""}${about ? `. ${about}` : ""}`);
    for (const side of SIDES) {
      for (const k of [0, 1, 2]) {
        const fault = own.find((one) => one.site && one.site[0] === side && one.site[1] === k);
        this.sites[side][k].show(tooth, side, k, `Tooth ${name}`, fault?.text);
        this.sites[side][k].button.disabled = isMissing;
      }
      this.pictures[side].show(tooth, side);
    }
  }
}

/** The lower jaw. `onSelect({fdi, side, place})` is called for a site, with `side` null for a whole tooth. */
export class Jaw {
  constructor(place, model, onSelect) {
    this.place = place;
    this.model = model;
    this.columns = new Map();
    const halves = [model.teeth.filter((fdi) => fdi >= 40), model.teeth.filter((fdi) => fdi < 40)];
    for (const [k, teeth] of halves.entries()) {
      const half = make("div", "half");
      half.dataset.name = ["Patient's right", "Patient's left"][k];
      for (const fdi of teeth) {
        const column = new Column(fdi, onSelect, (one) => onSelect({ fdi: one, side: null, place: 1 }));
        this.columns.set(fdi, column);
        half.append(column.element);
      }
      place.append(half);
    }
  }

  show(chart, teeth, faults, isUniversal) {
    for (const [fdi, column] of this.columns) {
      column.show(teeth.get(fdi), numbered(fdi, isUniversal), faults, chart.missing.includes(fdi));
    }
  }

  /** The button of a place. */
  button({ fdi, side, place }) {
    const column = this.columns.get(fdi);
    return side && !column.element.classList.contains("missing") ? column.sites[side][place].button : column.head;
  }

  /** Marks a place, which alone is reached by the tabulator. */
  select(at) {
    for (const one of this.place.querySelectorAll("[aria-current], [tabindex='0']")) {
      one.removeAttribute("aria-current");
      one.tabIndex = -1;
    }
    const button = this.button(at);
    button.setAttribute("aria-current", "true");
    button.tabIndex = 0;
    return button;
  }
}
