// Classes: the file of a roster goes into the form as text; a page prints itself.

/** Text of a file's bytes: UTF-16 and UTF-8 by their marks, else UTF-8, else the code page of western spreadsheets. */
export function decoded(bytes) {
  const marks = { "utf-16le": [0xff, 0xfe], "utf-16be": [0xfe, 0xff] };
  for (const [name, mark] of Object.entries(marks)) {
    if (mark.every((byte, at) => bytes[at] === byte)) {
      return new TextDecoder(name).decode(bytes);
    }
  }
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("windows-1252").decode(bytes);
  }
}

for (const input of document.querySelectorAll("input[data-roster]")) {
  const area = document.getElementById(input.dataset.roster);
  const told = document.getElementById("read");
  input.addEventListener("change", async () => {
    const [file] = input.files;
    if (!file) {
      return;
    }
    // The server takes a table of 1 MiB with the marks of the form around it.
    if (file.size > 700_000) {
      told.textContent = `${file.name} has ${file.size} bytes, expected at most 700,000: divide the table`;
      return;
    }
    area.value = decoded(new Uint8Array(await file.arrayBuffer()));
    told.textContent = `${file.name} is in the field above: look at the names, then check every line`;
  });
}
for (const button of document.querySelectorAll("[data-print]")) {
  button.addEventListener("click", () => print());
}
