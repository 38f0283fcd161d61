// The form of a case: a chart that is clicked and typed, with undo, check, save and compilation.

import { ask, choices, compiling, make, tell, useAt } from "./ask.js";
import { isMolar, Jaw, numbered, order, SIDES, siteName } from "./case-chart.js";
import { counts, diagnosis } from "./counts.js";
import { Patient } from "./patient.js";

/** Pause between two looks while no case is compiled, ms. */
const REST_MS = 4000;
/** Pause between two looks at a compilation, ms. */
const LOOK_MS = 700;
/** Pause after the last change before the check, ms. */
const CHECK_MS = 500;
const NUMBERS = "sulcus-numbers";

const by = (id) => document.getElementById(id);
const name = by("name").dataset.case;
const api = `/api/cases/${encodeURIComponent(name)}`;

let model;
let patient;
let version = "";
let opened;
let faults = [];
let jaw;
let at = null;
let work = { running: null, waiting: [], failed: [], ended: 0 };
let checking = 0;

const isUniversal = () => by("numbers").value === "universal";
const shownTooth = (fdi) => numbered(fdi, isUniversal());

/** Sentence of a fault in the words of the page, instead of the keys of the file. */
function plain(fault) {
  const text = fault.text
    .replace("`depth_mm` plus `recession_mm`", "attachment loss")
    .replaceAll("`depth_mm`", "depth")
    .replaceAll("`recession_mm`", "margin")
    .replaceAll("`", "")
    .replace(/ of tooth (\d\d)/, (_, fdi) => ` of tooth ${shownTooth(Number(fdi))}`);
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Changes the chart by `act`, in one step of the history. */
function change(act) {
  if (patient.change(act)) {
    changed();
  }
}

/** Goes a step back or forward in the history. */
function step(isBack) {
  if (isBack ? patient.undo() : patient.redo()) {
    by("label").value = patient.chart.label;
    changed();
  }
}

function changed() {
  show();
  clearTimeout(checking);
  checking = setTimeout(check, CHECK_MS);
}

async function check() {
  clearTimeout(checking);
  const asked = patient.text();
  const told = await ask("/api/cases-check", patient.chart);
  if (asked !== patient.text()) {
    return;
  }
  if (!told.ok) {
    tell(by("checked"), told.error, true);
    return;
  }
  faults = told.data.faults;
  show();
}

// ---- what is shown

function show() {
  jaw.show(patient.chart, patient.teeth(), faults.map((fault) => ({ ...fault, text: plain(fault) })), isUniversal());
  if (at) {
    jaw.select(at);
  }
  showState();
  showEditor();
  showSummary();
  showFaults();
}

function showState() {
  const isCurrent = opened.state === "compiled";
  const parts = [patient.isDirty() ? "changes are not saved" : isCurrent ? `compiled ${opened.compiled}` : opened.words];
  if (opened.compiled && (patient.isDirty() || !isCurrent)) {
    parts.push(`last compiled ${opened.compiled}`);
  }
  if (opened.users.length > 0) {
    parts.push(`in use at ${opened.users.join(", ")}`);
  }
  tell(by("state"), parts.join(", "));
  by("save").disabled = !patient.isDirty();
  by("undo").disabled = patient.done.length === 0;
  by("redo").disabled = patient.undone.length === 0;
  const busy = compiling(work, name);
  by("compile").disabled = busy !== "" || faults.length > 0 || (!patient.isDirty() && opened.state === "compiled");
  by("stop").hidden = busy === "";
  const why = work.failed.find((one) => one[0] === name)?.[1];
  by("work").hidden = busy === "" && why === undefined;
  by("progress").hidden = busy === "";
  by("progress").value = work.running?.name === name ? work.running.percent : 0;
  const text = busy || (why ? `the compilation failed: ${why}` : "");
  if (by("stage").textContent !== text) {
    tell(by("stage"), text, busy === "" && why !== undefined);
  }
  const isCompiled = opened.compiled !== "";
  by("draw").disabled = !isCompiled || model.sides.length === 0 || "busy" in by("drawn").dataset;
  by("use").querySelector("button").disabled = !isCompiled;
  if (by("picture").hidden && !by("drawn").classList.contains("problem") && !by("drawn").dataset.busy) {
    const why = model.sides.length === 0 ? "This server draws no pictures." : "Compile the case first.";
    tell(by("drawn"), by("draw").disabled ? why : "The picture shows the compiled case.");
  }
  document.title = `${patient.isDirty() ? "* " : ""}${name} · Sulcus`;
}

function showEditor() {
  const own = at ? patient.tooth(at.fdi) : undefined;
  const isMissing = at !== null && own === undefined;
  const isSite = own !== undefined && at.side !== null;
  by("of-site").hidden = !isSite;
  by("of-tooth").hidden = at === null;
  if (!at) {
    tell(by("place"), "Click a site or a tooth of the chart");
    return;
  }
  const number = shownTooth(at.fdi);
  tell(by("place"), isSite ? `Tooth ${number}, ${siteName(at.side, at.place)}` : `Tooth ${number}${isMissing ? ", missing" : ""}`);
  const here = faults.filter((fault) => fault.fdi === at.fdi && (!fault.site || !isSite || (fault.site[0] === at.side && fault.site[1] === at.place)));
  tell(by("here"), here.map(plain).join(". "), true);
  by("missing").setAttribute("aria-pressed", String(isMissing));
  by("moves").hidden = isMissing;
  by("inflamed").hidden = isMissing;
  by("furcations").hidden = isMissing || !isMolar(at.fdi);
  if (!own) {
    return;
  }
  by("furcation-buccal").value = own.furcation[0];
  by("furcation-lingual").value = own.furcation[1];
  by("mobility").value = own.mobility;
  setValue("inflammation", own.inflammation);
  if (isSite) {
    const depth = own.depth_mm[at.side][at.place];
    const margin = own.recession_mm[at.side][at.place];
    setValue("depth", depth);
    setValue("margin", margin);
    by("loss").textContent = `${depth + margin} mm`;
    by("bleeding").setAttribute("aria-pressed", String(own.bleeding[at.side][at.place]));
    for (const digit of by("digits").children) {
      digit.setAttribute("aria-pressed", String(Number(digit.textContent) === depth));
    }
  }
}

/** Sets an input that nobody is typing into. */
function setValue(id, value) {
  const input = by(id);
  if (document.activeElement !== input || Number(input.value) !== value) {
    input.value = value;
  }
}

function showSummary() {
  const found = counts(patient.chart);
  const pairs = [...found, ["Suggestion by the 2017 classification", diagnosis(patient.chart)]];
  by("summary").replaceChildren(...pairs.flatMap(([title, text]) => [make("dt", "", title), make("dd", "", text)]));
}

function showFaults() {
  const count = faults.length;
  tell(by("checked"), count === 0 ? "No fault." : `${count} ${count === 1 ? "value has" : "values have"} a fault. The case can be saved, but not compiled.`, count > 0);
  by("faults").replaceChildren(
    ...faults.map((fault) => {
      const go = make("button", "", plain(fault));
      go.type = "button";
      go.addEventListener("click", () => {
        if (fault.fdi && model.teeth.includes(fault.fdi)) {
          const [side, place] = fault.site ?? [null, 1];
          select({ fdi: fault.fdi, side, place }, true);
        } else {
          by("label").focus();
        }
      });
      return make("li", "", go);
    }),
  );
}

function showUpper() {
  const numbers = [18, 17, 16, 15, 14, 13, 12, 11, 21, 22, 23, 24, 25, 26, 27, 28];
  const greyed = numbers.map((fdi) => make("span", "", shownTooth(fdi)));
  by("upper").replaceChildren(make("b", "", "Upper jaw: not part of the model"), ...greyed);
}

// ---- selection

function select(where, isFocused) {
  at = where;
  if (at.side && !patient.tooth(at.fdi)) {
    at = { ...at, side: null };
  }
  const button = jaw.select(at);
  if (isFocused) {
    button.focus();
    button.scrollIntoView({ block: "nearest" });
  }
  showEditor();
}

/** Sites of a side from left to right on the page; a missing tooth is one place. */
function line(side) {
  return model.teeth.flatMap((fdi) => (patient.tooth(fdi) ? order(fdi).map((place) => ({ fdi, side, place })) : [{ fdi, side: null, place: 1 }]));
}

function move(by) {
  const side = at.side ?? "buccal";
  const all = line(side);
  const from = all.findIndex((one) => one.fdi === at.fdi && (one.side === null || at.side === null || one.place === at.place));
  const next = all[from + by];
  if (next) {
    select({ ...next, side: next.side }, true);
  }
}

function across(side) {
  if (patient.tooth(at.fdi)) {
    select({ ...at, side }, true);
  }
}

// ---- changes

function set(key, value) {
  const where = at;
  if (where?.side && patient.tooth(where.fdi) && Number.isFinite(value)) {
    change(() => {
      patient.tooth(where.fdi)[key][where.side][where.place] = value;
    });
  }
}

function setDepth(value) {
  set("depth_mm", value);
  if (by("onward").getAttribute("aria-pressed") === "true") {
    move(1);
  }
}

function moveMargin(mm) {
  if (at?.side && patient.tooth(at.fdi)) {
    const [highest, lowest] = model.recession_mm;
    const margin = patient.tooth(at.fdi).recession_mm[at.side][at.place] + mm;
    set("recession_mm", Math.max(highest, Math.min(lowest, margin)));
  }
}

function bleed() {
  const where = at;
  if (where?.side && patient.tooth(where.fdi)) {
    change(() => {
      const side = patient.tooth(where.fdi).bleeding[where.side];
      side[where.place] = !side[where.place];
    });
  }
}

function toggleMissing() {
  if (patient.toggleMissing(at.fdi)) {
    changed();
  }
  select({ ...at }, false);
}

function setTooth(act) {
  const { fdi } = at;
  if (patient.tooth(fdi)) {
    change(() => act(patient.tooth(fdi)));
  }
}

// ---- server

function take(loaded) {
  opened = loaded;
  version = loaded.version;
  faults = loaded.faults;
  patient.take(loaded.chart);
  by("label").value = patient.chart.label;
}

async function load() {
  const told = await ask(api);
  if (!told.ok) {
    tell(by("state"), told.error, true);
    return false;
  }
  const { case: loaded, stations } = told.data;
  model = told.data.model;
  work = told.data.work;
  if (!loaded.chart) {
    opened = loaded;
    tell(by("state"), `The patient file cannot be read: ${loaded.fault}. Correct the file by hand.`, true);
    for (const part of document.querySelectorAll("main .bar, main .sheet")) {
      part.hidden = true;
    }
    return false;
  }
  patient = new Patient(model, loaded.chart);
  take(loaded);
  choices(by("use-station"), stations);
  choices(by("use-exercise"), model.exercises);
  by("side").replaceChildren(
    ...model.sides.map((side) => {
      const option = make("option", "", side.about);
      option.value = side.name;
      return option;
    }),
  );
  return true;
}

async function save() {
  if (!patient.isDirty()) {
    return true;
  }
  const sent = patient.text();
  const told = await ask(api, { version, chart: patient.chart });
  if (told.ok) {
    const isSame = sent === patient.text();
    const mine = patient.chart;
    take(told.data.case);
    if (!isSame) {
      // Typed while the request was on its way.
      patient.chart = mine;
    }
    tell(by("answer"), "saved");
    show();
    return true;
  }
  if (told.status === 409 && told.error.includes("another person")) {
    tell(by("answer"), "not saved: another person saved this case in the meantime", true);
    by("conflict-name").value = `${name}-2`;
    by("conflict").showModal();
  } else {
    tell(by("answer"), `not saved: ${told.error}`, true);
  }
  return false;
}

/** Saves the chart of this page as a case of its own. */
async function saveAs(other) {
  const path = `/api/cases/${encodeURIComponent(other)}`;
  const made = await ask("/api/cases", { name: other, copy_of: name });
  const fresh = made.ok ? await ask(path) : made;
  const told = fresh.ok ? await ask(path, { version: fresh.data.case.version, chart: patient.chart }) : fresh;
  if (told.ok) {
    patient.saved = patient.text();
    location.assign(`/cases/${encodeURIComponent(other)}`);
  } else {
    tell(by("answer"), `not saved: ${told.error}`, true);
  }
}

async function look() {
  const told = await ask("/api/cases-work");
  if (!told.ok) {
    return;
  }
  const before = work;
  work = told.data;
  if (before.ended !== work.ended || Boolean(before.running) !== Boolean(work.running)) {
    const again = await ask(api);
    if (again.ok && again.data.case.version === version) {
      const { words, state, compiled, users, warnings } = again.data.case;
      Object.assign(opened, { words, state, compiled, users, warnings });
    }
  }
  showState();
}

/** Looks at the compilations again and again, more often while one runs. */
function again() {
  const isBusy = work.running !== null || work.waiting.length > 0;
  setTimeout(
    async () => {
      if (!document.hidden) {
        await look();
      }
      again();
    },
    isBusy ? LOOK_MS : REST_MS,
  );
}

async function draw() {
  const side = by("side").value;
  const path = `${api}/picture/${side}?of=${encodeURIComponent(opened.compiled)}`;
  by("draw").disabled = true;
  by("drawn").dataset.busy = "yes";
  tell(by("drawn"), "the mouth is being drawn, which takes some seconds");
  const answer = await fetch(path, { cache: "no-store" });
  if (answer.ok) {
    const picture = by("picture");
    picture.src = path;
    picture.alt = `Lower jaw of the case ${name}, ${by("side").selectedOptions[0].textContent}`;
    picture.hidden = false;
    const isOld = opened.state !== "compiled" || patient.isDirty();
    tell(by("drawn"), isOld ? "The picture is that of the last compilation, before the newest changes." : "The picture is that of the compiled case.");
  } else {
    const told = await answer.json().catch(() => ({}));
    tell(by("drawn"), told.error ?? `the server answers ${answer.status}`, true);
  }
  delete by("drawn").dataset.busy;
  by("draw").disabled = false;
}

// ---- events

function onKey(event) {
  if (!at || event.altKey || event.ctrlKey || event.metaKey) {
    return;
  }
  const acts = {
    ArrowLeft: () => move(-1),
    ArrowRight: () => move(1),
    ArrowUp: () => across(SIDES[0]),
    ArrowDown: () => across(SIDES[1]),
    "+": () => moveMargin(1),
    "-": () => moveMargin(-1),
    b: bleed,
    B: bleed,
  };
  const act = /^[0-9]$/.test(event.key) ? () => setDepth(Number(event.key) || 10) : acts[event.key];
  if (act) {
    event.preventDefault();
    act();
  }
}

function listen() {
  by("chart").addEventListener("keydown", onKey);
  document.addEventListener("keydown", (event) => {
    const isTyping = event.target.matches("input");
    if (!(event.ctrlKey || event.metaKey)) {
      return;
    }
    if (event.key === "s") {
      event.preventDefault();
      save();
    } else if (event.key === "z" && !isTyping) {
      event.preventDefault();
      step(!event.shiftKey);
    } else if (event.key === "y" && !isTyping) {
      event.preventDefault();
      step(false);
    }
  });
  for (let mm = 1; mm <= 10; mm += 1) {
    const digit = make("button", "", String(mm));
    digit.type = "button";
    digit.addEventListener("click", () => setDepth(mm));
    by("digits").append(digit);
  }
  const number = (id, act) => by(id).addEventListener("change", () => act(by(id).valueAsNumber));
  number("depth", (value) => set("depth_mm", value));
  number("margin", (value) => set("recession_mm", value));
  number("inflammation", (value) => Number.isFinite(value) && setTooth((own) => (own.inflammation = value)));
  by("mobility").addEventListener("change", (event) => setTooth((own) => (own.mobility = Number(event.target.value))));
  ["buccal", "lingual"].forEach((side, k) => {
    by(`furcation-${side}`).addEventListener("change", (event) => setTooth((own) => (own.furcation[k] = Number(event.target.value))));
  });
  by("label").addEventListener("change", (event) => change((chart) => (chart.label = event.target.value.trim())));
  const click = (id, act) => by(id).addEventListener("click", act);
  click("higher", () => moveMargin(-1));
  click("lower", () => moveMargin(1));
  click("bleeding", bleed);
  click("onward", (event) => {
    const isOn = event.target.getAttribute("aria-pressed") === "true";
    event.target.setAttribute("aria-pressed", String(!isOn));
  });
  click("missing", toggleMissing);
  click("undo", () => step(true));
  click("redo", () => step(false));
  click("save", save);
  click("check", check);
  click("draw", draw);
  click("compile", async () => {
    if (await save()) {
      const told = await ask(`${api}/compile`, {});
      tell(by("answer"), told.ok ? "compilation asked" : told.error, !told.ok);
      look();
    }
  });
  click("stop", async () => {
    await ask(`${api}/cancel`, {});
    look();
  });
  by("numbers").value = localStorage.getItem(NUMBERS) ?? "fdi";
  by("numbers").addEventListener("change", () => {
    localStorage.setItem(NUMBERS, by("numbers").value);
    showUpper();
    show();
  });
  by("use").addEventListener("submit", async (event) => {
    event.preventDefault();
    const isOld = patient.isDirty() || opened.state !== "compiled";
    tell(by("used"), "the plan is being set");
    const told = await useAt(name, by("use-station").value, by("use-exercise").value);
    tell(by("used"), told.ok && isOld ? `${told.text}. The station has the last compilation, without the newest changes.` : told.text, !told.ok);
    const again = await ask(api);
    if (again.ok) {
      opened.users = again.data.case.users;
      showState();
    }
  });
  by("copy").addEventListener("submit", async (event) => {
    event.preventDefault();
    const other = by("copy-name").value.trim();
    const told = await ask("/api/cases", { name: other, copy_of: name });
    if (told.ok) {
      location.assign(`/cases/${encodeURIComponent(other)}`);
    } else {
      tell(by("answer"), told.error, true);
    }
  });
  by("conflict").addEventListener("close", async () => {
    const choice = by("conflict").returnValue;
    by("conflict").returnValue = "";
    if (choice === "copy") {
      await saveAs(by("conflict-name").value.trim());
    } else if (choice === "load" && (await load())) {
      tell(by("answer"), "the other version is loaded");
      show();
    }
  });
  click("remove", () => by("sure").showModal());
  by("sure").addEventListener("close", async () => {
    if (by("sure").returnValue === "yes") {
      const told = await ask(`${api}/remove`, {});
      if (told.ok) {
        patient.saved = patient.text();
        location.assign("/cases");
      } else {
        tell(by("answer"), told.error, true);
      }
    }
    by("sure").returnValue = "";
  });
  window.addEventListener("beforeunload", (event) => {
    if (patient.isDirty()) {
      event.preventDefault();
    }
  });
}

if (await load()) {
  jaw = new Jaw(by("chart"), model, (where) => select(where, true));
  listen();
  showUpper();
  const first = patient.chart.teeth[0]?.fdi ?? model.teeth[0];
  at = { fdi: first, side: patient.chart.teeth.length > 0 ? "buccal" : null, place: order(first)[0] };
  show();
  again();
}
