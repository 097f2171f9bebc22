// A cursor over the picture of a map: which cell is under it, its numbers, and the command that runs it.
(() => {
  const kinds = new Uint8Array(buffer(data.kinds));
  const columns = data.columns.map(({ name, values }) => ({ name, values: new Float64Array(buffer(values)) }));
  const [xs, ys] = data.axes.map((axis) => axis.values);
  const map = find("map");
  const pictures = [...map.querySelectorAll(".picture > svg")];
  // The drawing for wide or for narrow screens, and the positions of its cells.
  const shown = () => {
    const index = pictures.findIndex((svg) => svg.getBoundingClientRect().width > 0);
    return { svg: pictures[Math.max(index, 0)], sheet: data.sheets[Math.max(index, 0)] };
  };
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
    const { width_px: width, height_px: height, edges_px: [xEdges, yEdges] } = shown().sheet;
    const percent = (px, of) => `${(100 * px) / of}%`;
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
      .map(([name, value]) => inWords(name, value))
      .filter(Boolean);
    const place = data.axes.map(({ label }, i) => `${label} ${Number([xs[column], ys[line]][i].toPrecision(6))}`);
    const label = data.doubts[index] ? `uncertain: ${data.doubts[index]}` : data.labels[kinds[index]];
    const outside = data.outside.includes(index) ? ["outside the model of four links"] : [];
    const mirrored = data.mirrored.includes(index) ? ["under the mirrored ground motion"] : [];
    find("numbers").textContent = `${place.join(", ")}: ${[label, ...mirrored, ...outside, ...numbers].join(", ")}`;
    find("command").textContent = command(column, line);
  }

  /** Places of values in the command: `{cell.x}`, `{1/cell.x}` of its inverse, or `{2*cell.x}` of a multiple. */
  function command(column, line) {
    const values = { x: xs[column], y: ys[line] };
    const filled = (_, inverse, factor, axis) => String(inverse ? 1 / values[axis] : (factor ?? 1) * values[axis]);
    return data.command.replace(/\{(1\/)?(?:([\d.e-]+)\*)?cell\.([xy])\}/g, filled);
  }

  function cellAt(event) {
    const { svg, sheet } = shown();
    const box = svg.getBoundingClientRect();
    const scale = sheet.width_px / box.width;
    const column = within(sheet.edges_px[0], (event.clientX - box.left) * scale);
    const line = within(sheet.edges_px[1], (event.clientY - box.top) * scale);
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
  // Values that descend along the axis, as negative ones, have the last one below.
  const up = data.sheets[0].edges_px[1][0] > data.sheets[0].edges_px[1].at(-1) ? 1 : -1;
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, up], ArrowDown: [0, -up] };
  map.addEventListener("keydown", (event) => {
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    stays = true;
    const far = event.shiftKey ? 10 : 1;
    const clamp = (value, count) => Math.min(Math.max(value, 0), count - 1);
    show([clamp(chosen[0] + far * step[0], xs.length), clamp(chosen[1] + far * step[1], ys.length)]);
  });
  find("copy").addEventListener("click", copyCommand);
  // In print the picture is the wide one, with other positions.
  for (const change of ["resize", "beforeprint", "afterprint"]) window.addEventListener(change, () => show(chosen));
  show([Math.floor(xs.length / 2), Math.floor(ys.length / 2)]);

  // For scripts.
  window.archrock = {
    data,
    show,
    chosen: () => chosen,
    stays: () => stays,
    keep(cell) {
      stays = true;
      show(cell);
    },
  };
})();
