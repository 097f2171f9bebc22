// The curves of a run.
function* addCurves(plots, stage, data) {
  const [groundT, groundY] = curve(data.curves.ground_g);
  plots.add("Ground acceleration (g)", 150, groundT, [{ name: "ground", color: "--ink", values: groundY }]);
  yield;
  const bodies = data.bodies.length;
  const turns = data.bodies.map((_, body) => stage.turns(body));
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
  plots.add("Rotation (rad, anticlockwise)", 230, Array.from(stage.times.subarray(0, stage.historyCount)), turning, named);
  yield;
  // The page to try adds the history before the last change.
  if (data.before) {
    const [ts, ...values] = uPlot.join([[Array.from(stage.times.subarray(0, stage.historyCount)), turns[most]], data.before.curve]);
    const look = (name, axis) => ({ name, color: `--curve-${axis + 1}`, dash: dashes[axis], values: values[axis] });
    plots.add("Largest rotation (rad), now and before", 150, ts, data.before.names.map(look));
    yield;
  }
  for (const { curves } of data.points ?? []) {
    // Each curve is thinned separately, so their times differ.
    const [ts, ...values] = uPlot.join(curves.map(({ curve: encoded }) => curve(encoded)));
    const look = ({ name }, axis) => ({ name, color: `--curve-${axis + 1}`, dash: dashes[axis], values: values[axis] });
    plots.add("Displacement (mm)", 150, ts, curves.map(look));
    yield;
  }
  const [energyT, energyY] = curve(data.curves.energy);
  plots.add(data.energy_label, 150, energyT, [{ name: "energy", color: "--ink", values: energyY }]);
  yield;
  if (data.curves.excess) {
    const [excessT, excessY] = curve(data.curves.excess);
    const label = "Thrust line outside the arch (parts of the thickness, cut off at 1)";
    plots.add(label, 150, excessT, [{ name: "excess", color: "--ink", values: excessY }]);
    yield;
  }
}

// The page has the histories of both directions of the ground motion, and shows one of them.
document.addEventListener("change", ({ target }) => {
  const shown = window.archrock.data;
  if (target.id !== "direction" || !shown.other || target.value === shown.direction) return;
  const { other } = shown;
  other.other = shown;
  find("happened").textContent = other.words;
  window.archrock.renew(other);
});

createPlayer(data, addCurves);
