// All stations, those that need help first.

import { follow } from "./live.js";
import { Tile } from "./tile.js";

const URGENCY = ["alarm", "warning", "notice", "none"];
const PHASE = ["running", "waiting", "ready", "ending", "free"];
/** Time for which an order stays after a change, and after the last movement of a finger or a key over it, ms: a button
    must not move away under a finger. */
const STAYS = 2000;

const tiles = new Map();
const place = document.getElementById("stations");
const link = document.getElementById("link");
const summary = document.getElementById("summary");
let sorted = 0;
let touched = -STAYS;
for (const kind of ["pointermove", "pointerdown", "keydown"]) {
  place.addEventListener(kind, (event) => {
    // A browser tells of a movement too when the page moves under a resting pointer.
    if (kind !== "pointermove" || event.movementX !== 0 || event.movementY !== 0) {
      touched = performance.now();
    }
  });
}

function tile(name) {
  if (!tiles.has(name)) {
    const made = new Tile(name, false);
    made.number = tiles.size;
    tiles.set(name, made);
    place.append(made.element);
    sorted = 0;
  }
  return tiles.get(name);
}

function order(a, b) {
  const by = (list, key) => list.indexOf(key(a)) - list.indexOf(key(b));
  return (
    by(URGENCY, (tile) => tile.data.urgency) || by(PHASE, (tile) => tile.data.status.phase) || a.number - b.number
  );
}

/** Says how many stations run, and how many need help. */
function count() {
  const all = [...tiles.values()].filter((tile) => tile.data);
  const running = all.filter((tile) => tile.data.status.phase === "running").length;
  const help = all.filter((tile) => ["alarm", "warning"].includes(tile.data.urgency)).length;
  const text = `${running} of ${all.length} running, ${help} ${help === 1 ? "needs" : "need"} help`;
  if (summary.textContent !== text) {
    summary.textContent = text;
  }
}

function arrange() {
  const now = performance.now();
  if (sorted > 0 && now - Math.max(sorted, touched) < STAYS) {
    return;
  }
  sorted = now;
  // A moved element loses the focus.
  const focused = document.activeElement;
  const wanted = [...tiles.values()].filter((tile) => tile.data).sort(order);
  wanted.forEach((tile, k) => {
    if (place.children[k] !== tile.element) {
      place.insertBefore(tile.element, place.children[k]);
    }
  });
  if (place.contains(focused)) {
    focused.focus({ preventScroll: true });
  }
}

follow(
  (kind, data) => {
    if (kind === "all") {
      data.stations.forEach((station) => tile(station.station).take(station));
    } else if (kind === "status") {
      tile(data.station).take(data);
    }
    count();
    arrange();
  },
  (text, isLive) => {
    link.textContent = text;
    link.classList.toggle("problem", !isLive);
  },
);
