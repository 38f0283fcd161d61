// Replay of a moment, or the mouth of a case: the viewer in a frame, or the reason why there is none.

const place = document.getElementById("replay");
const told = document.getElementById("told");

async function show() {
  const answer = await fetch("/api/viewer", { cache: "no-store" });
  const said = await answer.json();
  if (!answer.ok) {
    throw new Error(said.error);
  }
  const theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const { session, at, patient } = place.dataset;
  const shows = patient === undefined
    ? `session=${encodeURIComponent(session)}&at=${encodeURIComponent(at)}`
    : `case=${encodeURIComponent(patient)}`;
  const frame = document.createElement("iframe");
  frame.title = patient === undefined ? "Replay in three dimensions" : "Mouth in three dimensions";
  frame.src = `${said.page}?${shows}&theme=${theme}`;
  window.addEventListener("message", (event) => {
    if (event.origin !== location.origin || event.source !== frame.contentWindow) {
      return;
    }
    if (event.data?.failed) {
      told.textContent = `No picture: ${event.data.failed}`;
    } else if (event.data?.started) {
      told.textContent = "";
      place.dataset.started = "yes";
    } else if (event.data?.seconds !== undefined) {
      place.dataset.seconds = event.data.seconds;
    }
  });
  place.replaceChildren(frame);
}

show().catch((error) => {
  told.textContent = `No picture: ${error.message}`;
});
