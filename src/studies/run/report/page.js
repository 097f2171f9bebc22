// Draws curves with uPlot, and animates the picture of stage.js.
// ---- the plots ----
const plots = [];
let following = false;

function follow(source) {
  if (following) return;
  following = true;
  const { min, max } = source.scales.x;
  for (const plot of plots) if (plot !== source) plot.setScale("x", { min, max });
  following = false;
}

function addPlot(label, tall, xs, curves, legend) {
  // Omits a plot whose curves are all zero throughout.
  if (curves.every(({ values }) => farthest(values) === 0)) return;
  const holder = document.createElement("div");
  holder.className = "plot";
  find("plots").append(holder);
  const axis = () => css("--ink");
  const look = { stroke: axis, grid: { stroke: () => css("--line"), width: 1 }, ticks: { stroke: axis, width: 1 } };
  const plot = new uPlot(
    {
      width: holder.clientWidth || 800,
      height: tall,
      title: label,
      legend: { show: false },
      scales: { x: { time: false } },
      cursor: { sync: { key: "archrock" }, drag: { x: true, y: false } },
      axes: [
        { ...look, size: 30, values: (_, splits) => splits.map((s) => `${Number(s.toPrecision(6))} s`) },
        { ...look, size: 64 },
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
      text.textContent = ys ? `${name}: ${Number((valueAt(xs, ys, time) ?? 0).toPrecision(4))}` : name;
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

function showInstant(plot) {
  plot.values?.();
  const instant = plot.over.querySelector(".instant");
  if (instant) instant.style.left = `${plot.valToPos(time, "x")}px`;
}

function zoom(factor) {
  if (plots.length === 0) return;
  const { min, max } = plots[0].scales.x;
  const half = (0.5 * (max - min)) / factor;
  const from = Math.max(start, Math.min(time - half, historyEnd - 2 * half));
  plots[0].setScale("x", { min: from, max: Math.min(historyEnd, from + 2 * half) });
}

const showAll = () => plots[0]?.setScale("x", { min: start, max: historyEnd });

function curve(encoded) {
  const values = new Float32Array(buffer(encoded));
  const half = values.length / 2;
  return [Array.from(values.subarray(0, half)), Array.from(values.subarray(half))];
}

const [groundT, groundY] = curve(data.curves.ground_g);
addPlot("Ground acceleration (g)", 150, groundT, [{ name: "ground", color: "--ink", values: groundY }]);
const turns = data.bodies.map((_, body) =>
  Array.from({ length: historyCount }, (_, i) => rotations[i * bodies + body] * frames.rotation_unit_rad),
);
const most = data.largest_body;
const few = bodies <= 3;
const dashes = [[], [8, 4], [3, 3]];
const look = (body) =>
  few
    ? { name: data.bodies[body] || "rotation", color: `--curve-${body + 1}`, dash: dashes[body] }
    : body === most
      ? { name: `block ${data.bodies[body]}, which turns most`, color: "--curve-1", width: 2.5 }
      : { name: `block ${data.bodies[body]}`, color: "--soft", width: 0.6 };
// The block with the largest rotation is drawn above the others.
const order = data.bodies.map((_, body) => body);
if (!few) order.push(...order.splice(most, 1));
const turning = order.map((body) => ({ ...look(body), values: turns[body] }));
const named = few ? turning : [{ ...look(most), values: turns[most] }, { ...look((most + 1) % bodies), name: "other blocks" }];
addPlot("Rotation (rad, anticlockwise)", 230, Array.from(times.subarray(0, historyCount)), turning, named);
for (const { curves } of data.points ?? []) {
  // Each curve is thinned separately, so their times differ.
  const [ts, ...values] = uPlot.join(curves.map(({ curve: encoded }) => curve(encoded)));
  const look = ({ name }, axis) => ({ name, color: `--curve-${axis + 1}`, dash: dashes[axis], values: values[axis] });
  addPlot("Displacement (mm)", 150, ts, curves.map(look));
}
const [energyT, energyY] = curve(data.curves.energy);
addPlot(data.energy_label, 150, energyT, [{ name: "energy", color: "--ink", values: energyY }]);
if (data.curves.excess) {
  const [excessT, excessY] = curve(data.curves.excess);
  const label = "Thrust line outside the arch (parts of the thickness, cut off at 1)";
  addPlot(label, 150, excessT, [{ name: "excess", color: "--ink", values: excessY }]);
}
showAll();

// ---- time ----
const slider = find("time");
slider.min = start;
slider.max = end;
slider.step = "any";

function seek(to) {
  time = Math.min(Math.max(to, start), end);
  slider.value = time;
  slider.setAttribute("aria-valuetext", `${time.toFixed(3)} s`);
  draw();
  plots.forEach(showInstant);
}

const still = window.matchMedia("(prefers-reduced-motion: reduce)");
let last = null;

function tick(now) {
  if (!playing) return;
  // With reduced motion the page shows four pictures per second.
  const elapsed = last === null ? 0 : (now - last) / 1000;
  if (last === null || !still.matches || elapsed >= 0.25) {
    last = now;
    seek(time + elapsed * Number(find("speed").value));
    if (time >= end) play(false);
  }
  requestAnimationFrame(tick);
}

function play(on) {
  if (on && time >= end) seek(start);
  const starts = on && !playing;
  playing = on;
  last = null;
  find("play").textContent = on ? "Pause" : "Play";
  find("play").setAttribute("aria-pressed", String(on));
  if (starts) requestAnimationFrame(tick);
}

/** Moves the time by a number of frames. */
function stepBy(steps) {
  play(false);
  const { frame } = moment(time + 1e-9);
  seek(times[Math.min(Math.max(frame + steps, 0), count - 1)]);
}

function exaggerate(to) {
  find("exaggeration").value = to;
  find("times").textContent = find("exaggeration").value;
  draw();
}

find("play").addEventListener("click", () => play(!playing));
slider.addEventListener("input", () => {
  play(false);
  seek(Number(slider.value));
});
find("exaggeration").addEventListener("input", () => exaggerate(find("exaggeration").value));
for (const id of ["thrust", "ride", "sizes"]) find(id).addEventListener("change", draw);
find("fall").hidden = !data.fall_end;
find("fall-from").textContent = Number(historyEnd.toFixed(3));
find("fall-end").textContent = data.fall_end ?? "";
find("sizes-choice").hidden = data.dimensions.length === 0;
find("thrust-choice").hidden = !frames.thrust_unit;
find("stress").hidden = !frames.largest_stress_pa;
if (frames.largest_stress_pa) {
  find("largest-stress").textContent = Number((frames.largest_stress_pa / 1e6).toPrecision(3));
}

const exaggeration = () => Number(find("exaggeration").value);
const keys = {
  " ": () => play(!playing),
  ArrowLeft: (event) => stepBy(event.shiftKey ? -10 : -1),
  ArrowRight: (event) => stepBy(event.shiftKey ? 10 : 1),
  Home: () => seek(start),
  End: () => seek(end),
  ArrowUp: () => exaggerate(exaggeration() + 1),
  ArrowDown: () => exaggerate(exaggeration() - 1),
  "+": () => zoom(1.5),
  "-": () => zoom(1 / 1.5),
  0: showAll,
  t: () => find("thrust").click(),
};
document.addEventListener("keydown", (event) => {
  const own = event.target.matches("button, select, summary, input:not(#time)");
  if (own || event.ctrlKey || event.metaKey || event.altKey) return;
  const act = keys[event.key] ?? keys[event.key.toLowerCase()];
  if (act) {
    event.preventDefault();
    act(event);
  }
});
window.addEventListener("resize", () => {
  for (const plot of plots) plot.setSize({ width: plot.root.parentElement.clientWidth, height: plot.height });
  seek(time);
});
// In print the page is one sheet: structure and plots share the space beside the words.
const SHEET_PX = { width: 715, height: 1030 };
const LEAST_PX = { stage: 200, plot: 70 };
// Height of the title and the legend of a plot.
const BESIDE_PLOT_PX = 36;
window.addEventListener("beforeprint", () => {
  document.documentElement.classList.add("print");
  const { width: wide, height: tall } = SHEET_PX;
  const holder = find("plots");
  stage.style.height = "0";
  holder.style.display = "none";
  const words = document.body.scrollHeight;
  holder.style.display = "";
  const all = plots.reduce((sum, plot) => sum + plot.tall, 0);
  const least = words + LEAST_PX.stage + plots.length * (LEAST_PX.plot + BESIDE_PLOT_PX);
  const free = Math.max(tall - least, 0);
  stage.style.height = `${LEAST_PX.stage + 0.3 * free}px`;
  for (const plot of plots) {
    plot.setSize({ width: wide, height: Math.floor(LEAST_PX.plot + (0.65 * free * plot.tall) / all) });
  }
  if (least > tall) document.body.style.zoom = tall / least;
  seek(time);
});
window.addEventListener("afterprint", () => {
  document.documentElement.classList.remove("print");
  stage.style.height = document.body.style.zoom = "";
  for (const plot of plots) plot.setSize({ width: plot.root.parentElement.clientWidth, height: plot.tall });
  seek(time);
});
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const plot of plots) plot.redraw();
  draw();
});

/** Returns the exaggeration at which the largest displacement is a fifteenth of the size of the structure. */
function visible(at) {
  let farthestM = 0;
  const poses = posesAt(at);
  for (const { body, outline } of layouts[layoutOf[at.frame]].pieces) {
    for (let i = 0; i < outline.length; i += 2) {
      const [x, y] = [outline[i] * unitM, outline[i + 1] * unitM];
      const [nowX, nowY] = moved(body, x, y, poses, 1);
      farthestM = Math.max(farthestM, Math.hypot(nowX - x, nowY - y));
    }
  }
  const seen = Math.max(width, height) / 15;
  return farthestM > 0 ? Math.round(Math.min(Math.max(seen / farthestM, 1), 50)) : 1;
}

// The page opens at the time of overturning or of the largest rotation.
exaggerate(visible(moment(data.opens_s)));
seek(data.opens_s);

// Interface for scripts: state of the page, and functions that change it.
window.archrock = {
  data,
  seek,
  play,
  times,
  hingesAt,
  pressure,
  zoom,
  range: () => plots.map(({ scales }) => [scales.x.min, scales.x.max]),
  shown: () => ({ time, playing, poses: posesAt(moment(time)), state: STATES[states[moment(time).frame]] }),
};
