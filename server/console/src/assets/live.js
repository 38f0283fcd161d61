// Live data of the stations: the newest of each, changes as they come.

/** Calls `take(kind, data)` for each change, and `state(text, isLive)` for the state of the connection. */
export function follow(take, state) {
  let source;
  let waits = 0;

  async function everything() {
    const answer = await fetch("/api/stations", { cache: "no-store" });
    if (answer.status === 401) {
      location.assign("/sign-in");
      return;
    }
    if (!answer.ok) {
      throw new Error(`the server answers ${answer.status}`);
    }
    take("all", await answer.json());
    state("live", true);
  }

  function open() {
    source = new EventSource("/api/events");
    // The first message of a stream is always `lag`: the page then asks for everything.
    source.addEventListener("lag", () => {
      everything().catch((error) => state(String(error.message), false));
    });
    for (const kind of ["status", "event"]) {
      source.addEventListener(kind, (message) => {
        waits = 0;
        take(kind, JSON.parse(message.data));
      });
    }
    source.addEventListener("signed-out", () => {
      source.close();
      location.assign("/sign-in");
    });
    source.onerror = () => {
      state("no connection to the server, trying again", false);
      // A browser gives up after an answer that is no stream.
      if (source.readyState === EventSource.CLOSED) {
        waits = Math.min(waits + 1, 10);
        setTimeout(open, 1000 * waits);
        everything().catch(() => {});
      }
    };
  }

  open();
  // A hidden page of a tablet may lose its stream without an error.
  document.addEventListener("visibilitychange", () => {
    if (document.visibilityState === "visible") {
      everything().catch((error) => state(String(error.message), false));
    }
  });
}

/** Sends an instruction. Returns a sentence for the instructor. */
export async function instruct(station, body) {
  const key = crypto.randomUUID();
  const path = `/api/stations/${encodeURIComponent(station)}/instruct`;
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "content-type": "application/json" },
      body: JSON.stringify({ key, ...body }),
    });
    if (answer.status === 401) {
      location.assign("/sign-in");
    }
    const told = await answer.json();
    if (told.taken) {
      const when = told.tick > 0 ? `in force from tick ${told.tick}` : "in force for the next session";
      return { ok: true, tick: told.tick, text: told.text ? `${when}; ${told.text}` : when };
    }
    return { ok: false, tick: 0, text: `refused: ${told.error ?? told.text}` };
  } catch (error) {
    return { ok: false, tick: 0, text: `not sent: ${error.message}` };
  }
}
