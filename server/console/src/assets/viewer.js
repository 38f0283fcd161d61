// The viewer in its frame: loads its program, asks for a path to the station's stream, shows the stream. Tells the page
// around it how far the stream is, or why there is none.

/** Interval between two looks at the viewer, ms. */
const LOOK = 1000;
/** Name of the timeline. */
const TIMELINE = "session";

const told = document.getElementById("told");
const query = new URLSearchParams(location.search);
const station = query.get("station") ?? "";
/** Recorded session, and the moment in it, seconds; empty for a live station. */
const session = query.get("session") ?? "";
const at = query.get("at") ?? "0";
/** Case whose mouth is shown; empty for a session. */
const patient = query.get("case") ?? "";

function tell(message) {
  parent.postMessage({ from: "sulcus-viewer", ...message }, location.origin);
}

function fail(why) {
  told.textContent = why;
  tell({ failed: why });
}

async function path() {
  const own = patient ? `/api/cases/${encodeURIComponent(patient)}/mouth` : session
    ? `/api/results/${encodeURIComponent(session)}/replay?at=${encodeURIComponent(at)}`
    : `/api/stations/${encodeURIComponent(station)}/live`;
  const answer = await fetch(own, { method: "POST" });
  const said = await answer.json();
  if (!answer.ok) {
    throw new Error(said.error);
  }
  return said.path;
}

async function start() {
  if (!document.createElement("canvas").getContext("webgl2")) {
    throw new Error("this browser cannot draw in three dimensions");
  }
  await wasm_bindgen({ module_or_path: "re_viewer_bg.wasm" });
  told.textContent = patient ? "drawing the mouth" : session ? "replaying the session" : "waiting for the station";
  const url = new URL(await path(), location.origin).href;
  const handle = new wasm_bindgen.WebHandle({
    url: [url],
    render_backend: "webgl",
    hide_welcome_screen: true,
    enable_history: false,
    notebook: false,
    persist: false,
    panel_state_overrides: { top: "Hidden", blueprint: "Hidden", selection: "Hidden", time: "Collapsed" },
    theme: query.get("theme") === "light" ? "light" : "dark",
  });
  const canvas = document.getElementById("canvas");
  canvas.hidden = false;
  await handle.start(canvas);
  told.hidden = true;
  tell({ started: true });
  const look = setInterval(() => {
    if (handle.has_panicked()) {
      clearInterval(look);
      told.hidden = false;
      fail("the viewer has failed");
      return;
    }
    const recording = handle.get_active_recording_id();
    const range = recording ? handle.get_timeline_time_range(recording, TIMELINE) : null;
    if (range) {
      // Nanoseconds.
      tell({ seconds: range.max / 1e9 });
    }
  }, LOOK);
}

start().catch((error) => fail(String(error.message ?? error)));
