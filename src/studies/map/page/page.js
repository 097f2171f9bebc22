"use strict";
// A cursor over the picture of a map: which cell is under it, its numbers, and the command that runs it.
(() => {
  const find = (id) => document.getElementById(id);
  const data = JSON.parse(find("data").textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const kinds = new Uint8Array(bytes(data.kinds));
  const columns = data.columns.map(({ name, values }) => ({ name, values: new Float64Array(bytes(values)) }));
  const [xs, ys] = data.axes.map((axis) => axis.values);
  const map = find("map");
  const svg = map.querySelector("svg");
  let chosen = [0, 0];
  let stays = false;

  /** The interval of ascending or descending edges that holds a place. */
  function within(edges, place) {
    for (let i = 0; i + 1 < edges.length; i += 1) {
      const [low, high] = [Math.min(edges[i], edges[i + 1]), Math.max(edges[i], edges[i + 1])];
      if (place >= low && place <= high) return i;
    }
    return -1;
  }

  function show([column, line]) {
    chosen = [column, line];
    const index = column * ys.length + line;
    const [xEdges, yEdges] = [data.axes[0].edges_px, data.axes[1].edges_px];
    const percent = (px, of) => `${(100 * px) / of}%`;
    const { width, height } = data.sheet_px;
    const top = Math.min(yEdges[line], yEdges[line + 1]);
    Object.assign(find("cell").style, {
      left: percent(xEdges[column], width),
      top: percent(top, height),
      width: percent(xEdges[column + 1] - xEdges[column], width),
      height: percent(Math.abs(yEdges[line + 1] - yEdges[line]), height),
    });
    const numbers = columns
      .map(({ name, values }) => [name, values[index]])
      .filter(([, value]) => !Number.isNaN(value))
      .map(([name, value]) => `${name} ${Number(value.toPrecision(5))}`);
    const place = data.axes.map(({ label }, i) => `${label} ${Number([xs[column], ys[line]][i].toPrecision(6))}`);
    const label = data.doubts[index] ? `uncertain: ${data.doubts[index]}` : data.labels[kinds[index]];
    const outside = data.outside.includes(index) ? ["outside the model of four links"] : [];
    find("numbers").textContent = `${place.join(", ")}: ${[label, ...outside, ...numbers].join(", ")}`;
    find("command").textContent = command(column, line);
  }

  /** Places of values in the command: `{cell.x}`, or `{1/cell.x}` of its inverse. */
  function command(column, line) {
    const values = { x: xs[column], y: ys[line] };
    const filled = (_, inverse, axis) => String(inverse ? 1 / values[axis] : values[axis]);
    return data.command.replace(/\{(1\/)?cell\.([xy])\}/g, filled);
  }

  function cellAt(event) {
    const box = svg.getBoundingClientRect();
    const column = within(data.axes[0].edges_px, ((event.clientX - box.left) * data.sheet_px.width) / box.width);
    const line = within(data.axes[1].edges_px, ((event.clientY - box.top) * data.sheet_px.height) / box.height);
    return column < 0 || line < 0 ? null : [column, line];
  }

  map.addEventListener("pointermove", (event) => {
    const cell = cellAt(event);
    if (cell && !stays) show(cell);
  });
  map.addEventListener("click", (event) => {
    const cell = cellAt(event);
    if (!cell) return;
    stays = !(stays && cell[0] === chosen[0] && cell[1] === chosen[1]);
    show(cell);
  });
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  map.addEventListener("keydown", (event) => {
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    stays = true;
    const far = event.shiftKey ? 10 : 1;
    const clamp = (value, count) => Math.min(Math.max(value, 0), count - 1);
    show([clamp(chosen[0] + far * step[0], xs.length), clamp(chosen[1] + far * step[1], ys.length)]);
  });
  find("copy").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(find("command").textContent);
      find("copy").textContent = "Copied";
    } catch {
      // Where pages may not write to the clipboard, the text is selected for the keyboard.
      getSelection().selectAllChildren(find("command"));
    }
  });
  show([Math.floor(xs.length / 2), Math.floor(ys.length / 2)]);

  // For scripts.
  window.archrock = { data, show, chosen: () => chosen };
})();
