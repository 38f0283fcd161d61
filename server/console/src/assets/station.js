// One station: its tile, live view, plots, instructions, chart, events.

import { Chart } from "./chart.js";
import { follow, instruct } from "./live.js";
import { Plots } from "./plots.js";
import { Tile } from "./tile.js";
import { View } from "./view.js";

/** Number of events that are shown. */
const EVENTS = 100;

const name = document.getElementById("name").dataset.station;
const tile = new Tile(name, true);
const link = document.getElementById("link");
const events = document.getElementById("events");
const answer = document.getElementById("answer");
document.getElementById("station").append(tile.element);
const byId = (id) => document.getElementById(id);
const buttons = { solid: byId("solid"), flat: byId("flat"), again: byId("again") };
const view = new View(name, byId("view"), byId("view-told"), buttons);
const plots = new Plots(byId("plots"));
const chart = new Chart(name, byId("chart"), byId("chart-told"));

function take(data) {
  tile.take(data);
  view.take(data.status);
  plots.take(data.status);
  chart.take(data.status);
}

function show(event) {
  const data = { ...event.data };
  const item = document.createElement("li");
  item.dataset.kind = event.kind;
  const kind = document.createElement("b");
  kind.textContent = event.kind.replaceAll("_", " ");
  const rest = Object.entries(data).map(([key, value]) => `${key} ${typeof value === "number" ? +value.toFixed(3) : value}`);
  item.append(kind, ` at tick ${event.tick}${rest.length > 0 ? `: ${rest.join(", ")}` : ""}`);
  events.prepend(item);
  while (events.children.length > EVENTS) {
    events.lastChild.remove();
  }
}

async function give(label, body) {
  answer.textContent = `${label}: sent`;
  const told = await instruct(name, body);
  answer.textContent = `${label}: ${told.text}`;
  answer.dataset.tick = told.tick;
  answer.classList.toggle("problem", !told.ok);
  return told.ok;
}

document.getElementById("limit").addEventListener("submit", (event) => {
  event.preventDefault();
  const newtons = Number(new FormData(event.target).get("newtons"));
  give(`Limit of ${newtons} N`, { do: "limit", newtons });
});
document.getElementById("unlimited").addEventListener("click", () => give("Limit of the scene", { do: "limit", newtons: 0 }));
document.getElementById("words").addEventListener("submit", async (event) => {
  event.preventDefault();
  const input = document.getElementById("text");
  const kind = event.submitter?.value ?? "note";
  const label = { note: "Note", flag: "Flag", say: "Message" }[kind];
  if (await give(label, { do: kind, text: input.value })) {
    input.value = "";
  }
});
byId("ghost").addEventListener("click", () => give("Ghost", { do: "show_ghost" }));
byId("no-ghost").addEventListener("click", () => give("Ghost hidden", { do: "hide_ghost" }));
const sure = document.getElementById("sure");
document.getElementById("end").addEventListener("click", () => sure.showModal());
sure.addEventListener("close", () => {
  if (sure.returnValue === "yes") {
    give("End", { do: "end" });
  }
  sure.returnValue = "";
});

follow(
  (kind, data) => {
    if (kind === "all") {
      const own = data.stations.find((station) => station.station === name);
      if (own) {
        take(own);
        events.replaceChildren();
        own.events.forEach(show);
      }
    } else if (data.station === name && kind === "status") {
      take(data);
    } else if (data.station === name && kind === "event") {
      show(data);
      if (data.kind === "reading_called") {
        chart.call(data.data);
      }
    }
  },
  (text, isLive) => {
    link.textContent = text;
    link.classList.toggle("problem", !isLive);
  },
);
