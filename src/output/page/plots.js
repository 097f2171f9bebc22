// Curves over time, drawn with uPlot: all zoom together, and show one instant.

/** Returns the times and the values of an encoded curve. */
function curve(encoded) {
  const values = new Float32Array(buffer(encoded));
  const half = values.length / 2;
  return [Array.from(values.subarray(0, half)), Array.from(values.subarray(half))];
}

/** Returns the short text of a value on an axis: the axis has room for eight characters. */
function tick(value) {
  const rounded = Number(value.toPrecision(6));
  return rounded !== 0 && Math.abs(rounded) < 1e-3 ? rounded.toExponential() : String(rounded);
}

/** Removes the plots that the page shows. */
let removePlots = () => {};

/** Makes plots for an element, over the times from `start` to `end`. `seek` receives the time that is clicked. */
function createPlots(parent, { start, end }, seek) {
  const plots = [];
  const made = document.createDocumentFragment();
  let following = false;
  let shownTime = start;

  function follow(source) {
    if (following) return;
    following = true;
    const { min, max } = source.scales.x;
    for (const plot of plots) if (plot !== source) plot.setScale("x", { min, max });
    following = false;
  }

  function add(label, tall, xs, curves, legend) {
    // Omits a plot whose curves are all zero throughout.
    if (curves.every(({ values }) => farthest(values) === 0)) return;
    const holder = document.createElement("div");
    holder.className = "plot";
    made.append(holder);
    const axis = () => css("--ink");
    const look = { stroke: axis, grid: { stroke: () => css("--line"), width: 1 }, ticks: { stroke: axis, width: 1 } };
    const plot = new uPlot(
      {
        width: parent.clientWidth || 800,
        height: tall,
        title: label,
        legend: { show: false },
        // Points between pixels keep their place, or slow curves become stairs.
        pxAlign: 0,
        scales: { x: { time: false } },
        cursor: { sync: { key: "archrock" }, drag: { x: true, y: false } },
        axes: [
          { ...look, size: 30, values: (_, splits) => splits.map((s) => `${Number(s.toPrecision(6))} s`) },
          { ...look, size: 64, space: (_, __, ___, ____, px) => Math.min(30, px / 4), values: (_, splits) => splits.map(tick) },
        ],
        series: [{ label: "time", value: (_, v) => (v == null ? "" : `${v.toFixed(3)} s`) }].concat(
          curves.map(({ name, color, dash, width: thick, beyond }) => ({
            label: name,
            stroke: () => css(color),
            dash,
            width: thick ?? 1.6,
            points: { show: false },
            // Curves of an overturned structure do not set the scale of the plot.
            auto: !beyond,
            value: (_, v) => (v == null ? "" : Number(v.toPrecision(5)).toString()),
          })),
        ),
        hooks: { setScale: [(u, key) => key === "x" && follow(u)], draw: [showInstant] },
      },
      [xs, ...curves.map((curve) => curve.values)],
      holder,
    );
    plot.values = explain(holder, xs, curves, legend);
    plot.tall = tall;
    const instant = document.createElement("div");
    instant.className = "instant";
    plot.over.style.overflow = "hidden";
    plot.over.append(instant);
    let pressed = 0;
    plot.over.addEventListener("mousedown", (event) => (pressed = event.clientX));
    plot.over.addEventListener("mouseup", (event) => {
      if (Math.abs(event.clientX - pressed) < 4) {
        seek(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x"));
      }
    });
    plots.push(plot);
  }

  /** Adds the legend of a plot: each curve with its current value, or only the `names` of some curves. Returns a function that updates the values. */
  function explain(holder, xs, curves, names) {
    const list = document.createElement("p");
    list.className = "legend";
    holder.append(list);
    const shown = names ?? curves;
    const values = shown.map(({ name, color, dash, width: thick, values: ys }) => {
      const entry = document.createElement("span");
      entry.innerHTML = `<svg viewBox="0 0 28 8"><line x1="0" x2="28" y1="4" y2="4" stroke="var(${color})"
        stroke-width="${Math.max(thick ?? 2, 1)}" stroke-dasharray="${(dash ?? []).join(" ")}"/></svg> `;
      const text = document.createElement("span");
      entry.append(text);
      list.append(entry);
      return () => {
        text.textContent = ys ? `${name}: ${Number((valueAt(xs, ys, shownTime) ?? 0).toPrecision(4))}` : name;
      };
    });
    return () => values.forEach((show) => show());
  }

  /** Returns the value of a curve at time t, by linear interpolation. */
  function valueAt(xs, ys, t) {
    let [low, high] = [0, xs.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (xs[middle] <= t) low = middle;
      else high = middle;
    }
    if (ys[low] == null || ys[high] == null || xs[high] === xs[low]) return ys[high] ?? ys[low];
    const part = Math.min(Math.max((t - xs[low]) / (xs[high] - xs[low]), 0), 1);
    return ys[low] * (1 - part) + ys[high] * part;
  }

  /** Shows an instant in all plots. */
  function show(time) {
    shownTime = time;
    plots.forEach(showInstant);
  }

  function showInstant(plot) {
    plot.values?.();
    const instant = plot.over.querySelector(".instant");
    if (instant) instant.style.left = `${plot.valToPos(shownTime, "x")}px`;
  }

  function zoom(factor) {
    if (plots.length === 0) return;
    const { min, max } = plots[0].scales.x;
    const half = (0.5 * (max - min)) / factor;
    const from = Math.max(start, Math.min(shownTime - half, end - 2 * half));
    plots[0].setScale("x", { min: from, max: Math.min(end, from + 2 * half) });
  }

  const showAll = () => plots[0]?.setScale("x", { min: start, max: end });
  const remove = () => plots.forEach((plot) => plot.destroy());

  /** Puts the plots into their element, in place of earlier ones. */
  function place() {
    removePlots();
    removePlots = remove;
    parent.replaceChildren(made);
  }

  return { plots, add, remove, place, show, zoom, showAll };
}
