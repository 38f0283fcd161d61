// All cases: states, counts, compilations, a new case.

import { ask, choices, compiling, make, tell, useAt } from "./ask.js";

/** Pause between two looks while no case is compiled, ms. */
const REST_MS = 4000;
/** Pause between two looks at the compilations, ms. */
const LOOK_MS = 700;

const list = document.getElementById("cases");
const state = document.getElementById("state");
const answer = document.getElementById("answer");
const fresh = document.getElementById("new");
const use = document.getElementById("use");
const rows = new Map();
let ended = -1;
let isBusy = false;

function path(name, act) {
  return `/api/cases/${encodeURIComponent(name)}${act ? `/${act}` : ""}`;
}

function button(text, act, className = "") {
  const made = make("button", className, text);
  made.type = "button";
  made.addEventListener("click", act);
  return made;
}

async function compile(name) {
  const told = await ask(path(name, "compile"), {});
  tell(answer, told.ok ? `${name}: compilation asked` : `${name}: ${told.error}`, !told.ok);
  look();
}

function askUse(name) {
  document.getElementById("use-title").textContent = `Use ${name} at a station`;
  use.dataset.name = name;
  use.showModal();
}

function counts(summary) {
  if (!summary) {
    return "the patient file cannot be read";
  }
  const parts = [
    `${summary.teeth} teeth`,
    `mean depth ${summary.mean_depth_mm.toFixed(1)} mm`,
    `deepest ${summary.deepest_mm} mm`,
    `${summary.pockets} sites of 4 mm or more`,
    `bleeding ${summary.bleeding_percent.toFixed(0)} %`,
  ];
  if (summary.furcations > 0) {
    parts.push(`furcations at ${summary.furcations} ${summary.furcations === 1 ? "tooth" : "teeth"}`);
  }
  return parts.join(", ");
}

function row(one) {
  const item = make("li", "case");
  item.dataset.name = one.name;
  item.dataset.state = one.state;
  const link = make("a", "", one.name);
  link.href = `/cases/${encodeURIComponent(one.name)}`;
  const label = make("span", "label", one.label ?? "");
  const words = make("span", "state", one.words);
  item.append(make("h2", "", link, " ", words), make("p", "label", label), make("p", "counts", counts(one.summary)));
  if (one.fault) {
    item.append(make("p", "problem", one.fault));
  }
  for (const warning of one.warnings) {
    item.append(make("p", "counts", `Warning: ${warning}`));
  }
  const facts = [];
  if (one.compiled) {
    facts.push(`compiled ${one.compiled}`);
  }
  facts.push(one.users.length > 0 ? `in use at ${one.users.join(", ")}` : "in use nowhere");
  item.append(make("p", "counts", facts.join(", ")));
  const work = make("p", "work");
  work.setAttribute("role", "status");
  const bar = make("progress");
  bar.max = 100;
  bar.setAttribute("aria-label", `Compilation of ${one.name}`);
  const stop = button("Stop", async () => {
    await ask(path(one.name, "cancel"), {});
    look();
  });
  const text = make("span");
  work.append(bar, text, stop);
  const open = make("a", "button", "Open the chart");
  open.href = link.href;
  const acts = make("p", "acts", open);
  const isCompiled = one.compiled !== "";
  const build = button(isCompiled ? "Compile again" : "Compile", () => compile(one.name), one.state === "compiled" ? "" : "main");
  build.disabled = one.state === "faulty";
  const give = button("Use at a station", () => askUse(one.name), one.state === "compiled" ? "main" : "");
  give.disabled = !isCompiled;
  acts.append(build, give);
  item.append(work, acts);
  rows.set(one.name, { item, work, bar, text, stop, build });
  return item;
}

function showWork(work) {
  isBusy = work.running !== null || work.waiting.length > 0;
  const failed = new Map(work.failed);
  for (const [name, row] of rows) {
    const busy = compiling(work, name);
    const isRunning = work.running?.name === name;
    row.bar.hidden = !isRunning;
    row.bar.value = isRunning ? work.running.percent : 0;
    row.stop.hidden = busy === "";
    row.build.hidden = busy !== "";
    const why = failed.get(name);
    const told = busy || (why ? `the compilation failed: ${why}` : "");
    if (row.text.textContent !== told) {
      tell(row.text, told, busy === "" && why !== undefined);
    }
    row.work.hidden = told === "";
  }
}

async function everything() {
  const told = await ask("/api/cases");
  if (!told.ok) {
    tell(state, told.error, true);
    return;
  }
  const { cases, conditions, exercises, stations, work } = told.data;
  rows.clear();
  list.replaceChildren(...cases.map(row));
  const count = cases.length;
  tell(state, count === 0 ? "no cases yet: make the first one below" : `${count} ${count === 1 ? "case" : "cases"}`);
  const condition = fresh.elements.condition;
  if (condition.options.length === 0) {
    choices(condition, conditions);
    condition.value = conditions.at(-1).name;
    choices(use.querySelector("[name=station]"), stations);
    choices(use.querySelector("[name=exercise]"), exercises);
  }
  ended = work.ended;
  showWork(work);
}

async function look() {
  const told = await ask("/api/cases-work");
  if (!told.ok) {
    tell(state, told.error, true);
    return;
  }
  if (told.data.ended !== ended) {
    await everything();
  } else {
    showWork(told.data);
  }
}

fresh.addEventListener("submit", async (event) => {
  event.preventDefault();
  const name = fresh.elements.name.value.trim();
  const body = { name, condition: fresh.elements.condition.value, seed: fresh.elements.seed.value.trim() };
  const told = await ask("/api/cases", body);
  for (const input of fresh.elements) {
    input.removeAttribute("aria-invalid");
  }
  if (told.ok) {
    location.assign(`/cases/${encodeURIComponent(name)}`);
    return;
  }
  tell(answer, told.error, true);
  const wrong = fresh.elements[told.data.field];
  wrong?.setAttribute("aria-invalid", "true");
  wrong?.focus();
});

document.getElementById("draw").addEventListener("click", () => {
  fresh.elements.seed.value = String(crypto.getRandomValues(new Uint32Array(1))[0]);
});

use.addEventListener("close", async () => {
  if (use.returnValue === "yes") {
    const [station, exercise] = ["station", "exercise"].map((name) => use.querySelector(`[name=${name}]`).value);
    tell(answer, `${station}: the plan is being set`);
    const told = await useAt(use.dataset.name, station, exercise);
    tell(answer, told.text, !told.ok);
    await everything();
  }
  use.returnValue = "";
});

/** Looks at the compilations again and again, more often while one runs. */
function again() {
  setTimeout(
    async () => {
      if (!document.hidden && !use.open) {
        await look();
      }
      again();
    },
    isBusy ? LOOK_MS : REST_MS,
  );
}

await everything();
again();
