// Requests of a page, and small parts of pages.

/** Asks the server. Returns `{ok, status, data, error}`; `error` is a sentence. */
export async function ask(path, body) {
  const options = { cache: "no-store" };
  if (body !== undefined) {
    options.method = "POST";
    options.headers = { "content-type": "application/json" };
    options.body = JSON.stringify(body);
  }
  try {
    const answer = await fetch(path, options);
    if (answer.status === 401) {
      location.assign("/sign-in");
    }
    const data = await answer.json().catch(() => ({}));
    const error = answer.ok ? "" : (data.error ?? (data.text || `the server answers ${answer.status}`));
    return { ok: answer.ok, status: answer.status, data, error };
  } catch (error) {
    return { ok: false, status: 0, data: {}, error: `not sent: ${error.message}` };
  }
}

/** A new element with a class, a text and children. */
export function make(kind, className, ...content) {
  const element = document.createElement(kind);
  if (className) {
    element.className = className;
  }
  element.append(...content);
  return element;
}

/** Shows a sentence at an element. */
export function tell(element, text, isProblem = false) {
  element.textContent = text;
  element.classList.toggle("problem", isProblem);
}

/** Fills a selection with choices: texts, or `{name, about}`. Keeps the chosen one. */
export function choices(select, all) {
  const chosen = select.value;
  const options = all.map((one) => {
    const option = document.createElement("option");
    option.value = one.name ?? one;
    option.textContent = one.about ? `${one.name}: ${one.about}` : option.value;
    option.title = option.textContent;
    return option;
  });
  select.replaceChildren(...options);
  if (options.some((option) => option.value === chosen)) {
    select.value = chosen;
  }
}

/** Words for the compilation of a case; empty without one. */
export function compiling(work, name) {
  if (work.running?.name === name) {
    return `compiling: ${work.running.percent} %, ${work.running.stage}`;
  }
  return work.waiting.includes(name) ? "waits for its compilation" : "";
}

/** Sets the plan of a station to a case. Returns a sentence. */
export async function useAt(name, station, exercise) {
  const key = crypto.randomUUID();
  const told = await ask(`/api/cases/${encodeURIComponent(name)}/use`, { station, exercise, key });
  if (told.ok) {
    const more = told.data.text ? `; ${told.data.text}` : "";
    return { ok: true, text: `${station} has the case ${name} from its next session on${more}` };
  }
  return { ok: false, text: `${station}: refused: ${told.error}` };
}
