// Plays the motion of stage.js, with the controls of the page, the keys, and the instant of plots.js.
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
