// The cases of a page: the one under the pointer or chosen by keys, its row of the table, and its command.
(() => {
  const holder = find("points");
  const spots = [...holder.querySelectorAll(".spot")];
  const cells = [...document.querySelectorAll("#rows tbody tr")];
  const names = [...document.querySelectorAll("#rows thead th")].map((cell) => cell.textContent);
  let chosen = 0;
  let stays = false;

  /** The command that computes a case: a scenario with other values. */
  function command(row) {
    const { text, set } = data.cases[row];
    if (text === null) return "There is no command: the values make no valid structure, or the page of the model has too many cases.";
    const values = set.map((value) => ` --set ${value}`).join("");
    return `archrock ${data.command}${values} <<'END'\n${data.texts[text]}END\n`;
  }

  function show(row) {
    chosen = row;
    for (const spot of spots) spot.classList.toggle("chosen", Number(spot.dataset.row) === row);
    cells.forEach((line, index) => line.classList.toggle("chosen", index === row));
    const spot = spots.find((spot) => Number(spot.dataset.row) === row);
    const words = spot?.querySelector("title").textContent ?? "";
    const known = cells[row] ? [...cells[row].cells].map((cell, i) => [names[i], cell.textContent]) : [];
    find("case").textContent = words;
    find("case").className = ["overturns", "uncertain"].find((kind) => spot?.classList.contains(kind)) ?? "";
    find("numbers").textContent = known.map(([name, cell]) => cell && inWords(name, cell)).filter(Boolean).join(", ");
    const line = cells[row];
    const rows = line?.closest(".scroll");
    if (rows) rows.scrollTop = line.offsetTop - rows.clientHeight / 3;
    find("command").textContent = command(row);
    find("copy").textContent = "Copy";
  }

  /** The row of the case nearest to the pointer; `null` if all are far away. */
  function nearest(event) {
    let found = null;
    let least = 24;
    for (const spot of spots) {
      const box = spot.getBoundingClientRect();
      if (box.width === 0) continue;
      const apart = Math.hypot(event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2);
      if (apart < least) [least, found] = [apart, Number(spot.dataset.row)];
    }
    return found;
  }

  holder.addEventListener("pointermove", (event) => {
    const row = stays ? null : nearest(event);
    if (row !== null && row !== chosen) show(row);
  });
  holder.addEventListener("click", (event) => {
    const row = nearest(event);
    stays = row !== null && !(stays && row === chosen);
    if (row !== null) show(row);
  });
  const steps = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 };
  holder.addEventListener("keydown", (event) => {
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    stays = true;
    show(Math.min(Math.max(chosen + (event.shiftKey ? 10 : 1) * step, 0), data.cases.length - 1));
  });
  cells.forEach((line, row) => line.addEventListener("click", () => ((stays = true), row < data.cases.length && show(row))));
  find("copy").addEventListener("click", copyCommand);
  // In print the page is one sheet of A4. It has the first rows of the first table, as wide as the sheet, and says where all rows are.
  const SHEET_PX = 1030;
  const PRINTED_ROWS = 12;
  const notes = [...document.querySelectorAll(".table")].map((holder, index) => {
    const { name, all } = data.tables[index];
    const table = holder.querySelector("table");
    const rows = [...table.tBodies[0].rows];
    const printed = index === 0 ? Math.min(rows.length, PRINTED_ROWS) : 0;
    for (const cell of table.tHead.rows[0].cells) cell.innerHTML = cell.innerHTML.replaceAll("_", "_<wbr>");
    const note = document.createElement("p");
    note.className = "hint printed";
    note.textContent = printed > 0 ? `Rows 1 to ${printed} of ${all}, all in ${name}` : `${all} rows, all in ${name}`;
    return { holder, table, rows, printed, note, isCut: printed < all };
  });
  window.addEventListener("beforeprint", () => {
    for (const { holder, table, rows, printed, note, isCut } of notes) {
      rows.forEach((row, index) => (row.hidden = index >= printed));
      table.hidden = printed === 0;
      if (isCut) holder.append(note);
      if (printed > 0) table.style.zoom = Math.min(1, table.parentElement.clientWidth / table.scrollWidth);
    }
    const tall = document.body.scrollHeight;
    if (tall > SHEET_PX) document.body.style.zoom = (0.98 * SHEET_PX) / tall;
  });
  window.addEventListener("afterprint", () => {
    for (const { table, rows, note } of notes) {
      for (const row of rows) row.hidden = false;
      table.hidden = false;
      table.style.zoom = "";
      note.remove();
    }
    document.body.style.zoom = "";
  });
  show(Number(holder.querySelector(".overturns")?.dataset.row ?? 0));

  // For scripts.
  window.archrock = { data, show, command, chosen: () => chosen };
})();
