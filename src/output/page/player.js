// Plays a motion, with the controls of the page and the keys.

/** True if the motion is a part of a page with other things, which keeps its own keys and its own print. */
const isPart = document.body.classList.contains("host");

/** Fills the page with a motion, as for `createStage`, that has `opens_s`, the time at which the page opens, and `fall_end`, the end of the fall in words
 * if there is one. `addCurves` adds the curves to the plots, and yields after each plot. */
function createPlayer(motion, addCurves) {
  const canvas = find("stage");
  const slider = find("time");
  const stage = createStage(canvas, motion);
  const { times, start, end } = stage;
  const { frames } = motion;
  let time = start;
  let playing = false;
  // A page may show one motion after another: the last one leaves. Its plots stay until those of the next one are complete.
  const leaving = new AbortController();
  const { signal } = leaving;
  const curves = createPlots(find("plots"), { start, end: stage.historyEnd }, seek);
  const { plots } = curves;
  // A tall structure has a taller picture.
  const [low, high] = motion.frame_m;
  if (!isPart) canvas.style.aspectRatio = Math.min(Math.max((2.2 * (high[0] - low[0])) / (high[1] - low[1]), 1.25), 2);
  slider.min = start;
  slider.max = end;
  slider.step = "any";

  const view = () => ({
    exaggeration: Number(find("exaggeration").value),
    hasThrust: find("thrust").checked,
    hasSizes: find("sizes").checked,
    rides: find("ride").checked,
  });
  const draw = () => (find("now").textContent = stage.draw(time, view()));

  function seek(to) {
    time = Math.min(Math.max(to, start), end);
    slider.value = time;
    slider.setAttribute("aria-valuetext", `${time.toFixed(3)} s`);
    draw();
    curves.show(time);
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
    seek(times[Math.min(Math.max(stage.frame(time + 1e-9) + steps, 0), times.length - 1)]);
  }

  function exaggerate(to) {
    find("exaggeration").value = to;
    find("times").textContent = find("exaggeration").value;
    find("drawn").textContent = `Displacements are drawn ${find("exaggeration").value} times as large as they are.`;
    seek(time);
  }

  /** Makes the plots as wide as the page, which may have got a scroll bar. */
  function fit() {
    const width = find("plots").clientWidth;
    for (const plot of plots) if (plot.width !== width) plot.setSize({ width, height: plot.height });
  }

  async function addPlots() {
    for (const _ of addCurves(curves, stage, motion)) {
      // A page around this one answers its reader in between.
      if (isPart || window !== window.parent) await new Promise((resolve) => setTimeout(resolve));
      if (signal.aborted) return curves.remove();
    }
    curves.place();
    fit();
    curves.showAll();
  }

  find("play").addEventListener("click", () => play(!playing), { signal });
  slider.addEventListener("input", () => {
    play(false);
    seek(Number(slider.value));
  }, { signal });
  find("exaggeration").addEventListener("input", () => exaggerate(find("exaggeration").value), { signal });
  for (const id of ["thrust", "ride", "sizes"]) find(id).addEventListener("change", draw, { signal });
  find("fall").hidden = !motion.fall_end;
  find("fall-from").textContent = Number(stage.historyEnd.toFixed(3));
  find("fall-end").textContent = motion.fall_end ?? "";
  find("ride").checked = stage.goesFar;
  find("sizes-choice").hidden = motion.dimensions.length === 0;
  find("thrust-choice").hidden = !frames.thrust_unit;
  find("stress").hidden = !frames.largest_stress_pa;
  if (frames.largest_stress_pa) {
    find("largest-stress").textContent = Number((frames.largest_stress_pa / 1e6).toPrecision(3));
  }

  const keys = {
    " ": () => play(!playing),
    ArrowLeft: (event) => stepBy(event.shiftKey ? -10 : -1),
    ArrowRight: (event) => stepBy(event.shiftKey ? 10 : 1),
    Home: () => seek(start),
    End: () => seek(end),
    ArrowUp: () => exaggerate(view().exaggeration + 1),
    ArrowDown: () => exaggerate(view().exaggeration - 1),
    "+": () => curves.zoom(1.5),
    "-": () => curves.zoom(1 / 1.5),
    0: curves.showAll,
    t: () => find("thrust").click(),
  };
  (isPart ? canvas : document).addEventListener("keydown", (event) => {
    const own = event.target.matches("button, select, summary, input:not(#time)");
    if (own || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = keys[event.key] ?? keys[event.key.toLowerCase()];
    if (act) {
      event.preventDefault();
      act(event);
    }
  }, { signal });
  window.addEventListener("resize", () => {
    fit();
    seek(time);
  }, { signal });
  // In print the page is one sheet: structure and plots share the space beside the words.
  const SHEET_PX = { width: 715, height: 1030 };
  const LEAST_PX = { stage: 200, plot: 70 };
  // Height of the title and the legend of a plot.
  const BESIDE_PLOT_PX = 36;
  if (!isPart) window.addEventListener("beforeprint", () => {
    const { width: wide, height: tall } = SHEET_PX;
    const holder = find("plots");
    canvas.style.height = "0";
    holder.style.display = "none";
    const words = document.body.scrollHeight;
    holder.style.display = "";
    const all = plots.reduce((sum, plot) => sum + plot.tall, 0);
    const least = words + LEAST_PX.stage + plots.length * (LEAST_PX.plot + BESIDE_PLOT_PX);
    const free = Math.max(tall - least, 0);
    canvas.style.height = `${LEAST_PX.stage + 0.3 * free}px`;
    for (const plot of plots) {
      plot.setSize({ width: wide, height: Math.floor(LEAST_PX.plot + (0.65 * free * plot.tall) / all) });
    }
    if (least > tall) document.body.style.zoom = tall / least;
    if (playing) {
      play(false);
      time = motion.opens_s;
    }
    seek(time);
  }, { signal });
  if (!isPart) window.addEventListener("afterprint", () => {
    canvas.style.height = document.body.style.zoom = "";
    for (const plot of plots) plot.setSize({ width: find("plots").clientWidth, height: plot.tall });
    seek(time);
  }, { signal });
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    for (const plot of plots) plot.redraw();
    draw();
  }, { signal });

  // The page opens at the time of overturning or of the largest rotation; in motion it begins at the start.
  time = motion.opens_s;
  exaggerate(stage.visible(time));
  if (!isPart && !still.matches) {
    seek(start);
    play(true);
  }

  // Interface for scripts: state of the page, and functions that change it.
  window.archrock = {
    data: motion,
    seek,
    play,
    renew(next) {
      const plays = playing;
      play(false);
      leaving.abort();
      createPlayer(next, addCurves);
      if (plays) window.archrock.play(true);
      return window.archrock.ready;
    },
    ready: addPlots(),
    times,
    largest: () => [Array.from(times.subarray(0, stage.historyCount)), stage.turns(motion.largest_body)],
    hingesAt: stage.hingesAt,
    pressure: stage.pressure,
    zoom: curves.zoom,
    range: () => plots.map(({ scales }) => [scales.x.min, scales.x.max]),
    shown: () => ({ time, playing, poses: stage.poses(time), state: stage.state(time) }),
  };
}
