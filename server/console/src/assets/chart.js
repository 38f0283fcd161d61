// The chart as it fills: six sites of each tooth, called and by the scene.

/** Sites from left to right on the page, for the patient's right side; the left side is the mirror image. */
const ROWS = [
  ["Cheek", ["distobuccal", "buccal", "mesiobuccal"]],
  ["Tongue", ["distolingual", "lingual", "mesiolingual"]],
];
/** Difference between called and true depth that is marked, mm. */
const OFF = 1;

function made(name, properties = {}, children = []) {
  const element = document.createElement(name);
  Object.assign(element, properties);
  element.append(...children);
  return element;
}

/** Place of a tooth on the page: upper jaw first, the patient's right on the left. */
function order(tooth) {
  const quadrant = Math.floor(tooth / 10);
  const across = [1, 4].includes(quadrant) ? 9 - (tooth % 10) : 9 + (tooth % 10);
  return ([1, 2].includes(quadrant) ? 0 : 100) + across;
}

export class Chart {
  constructor(station, place, told) {
    Object.assign(this, { station, place, told });
    this.cells = new Map();
  }

  /** Takes the newest status of the station. */
  take(status) {
    if (this.recording !== status.recording) {
      this.recording = status.recording;
      this.load();
    }
  }

  async load() {
    const recording = this.recording;
    try {
      const answer = await fetch(`/api/stations/${encodeURIComponent(this.station)}/chart`, { cache: "no-store" });
      const data = await answer.json();
      if (!answer.ok) {
        throw new Error(data.error);
      }
      if (recording === this.recording) {
        this.fill(recording ? data : { sites: [], called: [] });
      }
    } catch (error) {
      this.told.textContent = `The chart is missing: ${error.message}`;
    }
  }

  fill({ sites, called }) {
    this.cells.clear();
    const teeth = new Map();
    for (const { tooth, site, depth_mm } of sites) {
      teeth.set(tooth, (teeth.get(tooth) ?? new Map()).set(site, depth_mm));
    }
    const all = [...teeth.keys()].sort((a, b) => order(a) - order(b));
    this.place.replaceChildren(...all.map((tooth) => this.tooth(tooth, teeth.get(tooth))));
    for (const reading of called) {
      this.call(reading);
    }
    this.count();
  }

  tooth(tooth, depths) {
    const isRight = [1, 4].includes(Math.floor(tooth / 10));
    const rows = ROWS.map(([label, sites]) => {
      const cells = (isRight ? sites : [...sites].reverse()).map((site) => {
        const cell = made("td", { title: `${tooth} ${site}` });
        const entry = { cell, tooth, site, truth: depths.get(site) ?? null, called: null };
        this.cells.set(`${tooth} ${site}`, entry);
        this.show(entry);
        return cell;
      });
      return made("tr", {}, [made("th", { scope: "row", textContent: label }), ...cells]);
    });
    const table = made("table", {}, [made("caption", { textContent: tooth }), made("tbody", {}, rows)]);
    return made("li", {}, [table]);
  }

  /** Takes a reading that the student has called. */
  call({ tooth, site, depth_mm }) {
    const entry = this.cells.get(`${tooth} ${site}`);
    if (entry) {
      entry.called = depth_mm;
      this.show(entry);
      this.count();
    }
  }

  show({ cell, tooth, site, truth, called }) {
    const isOff = called !== null && truth !== null && Math.abs(called - truth) > OFF;
    const main = made("b", { textContent: called === null ? "–" : `${called}${isOff ? "≠" : ""}` });
    const small = made("small", { textContent: truth === null ? "" : truth.toFixed(1) });
    cell.classList.toggle("off", isOff);
    const said = called === null ? "not called" : `called ${called} mm`;
    cell.setAttribute("aria-label", `${tooth} ${site}: ${said}${truth === null ? "" : `, by the scene ${truth.toFixed(1)} mm`}`);
    cell.replaceChildren(main, small);
  }

  count() {
    const all = [...this.cells.values()];
    const called = all.filter((entry) => entry.called !== null);
    const off = called.filter((entry) => entry.truth !== null && Math.abs(entry.called - entry.truth) > OFF);
    this.told.textContent =
      all.length === 0
        ? "The chart begins with the session."
        : `${called.length} of ${all.length} sites called, ${off.length} of them more than ${OFF} mm off (≠). Large: called, mm. Small: by the scene.`;
  }
}
