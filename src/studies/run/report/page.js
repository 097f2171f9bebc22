"use strict";
// Draws the motion on a canvas and its curves with uPlot. Everything is in #data, in metres, seconds and radians.
(() => {
  const find = (id) => document.getElementById(id);
  const data = JSON.parse(find("data").textContent);
  const buffer = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const { frames, sections, unit_m: unitM } = data;
  const bodies = data.bodies.length;

  // The poses of the bodies, and the layout of each frame.
  const { layouts } = data;
  const times = new Float64Array(buffer(frames.times_s));
  const rotations = new Int16Array(buffer(frames.rotations));
  const shifts = new Int16Array(buffer(frames.shifts));
  const layoutOf = new Uint16Array(buffer(frames.layouts));
  const groundM = new Float32Array(buffer(frames.ground_m));
  const groundG = new Float32Array(buffer(frames.ground_g));
  // Where the feet move differently: how far the right one has gone from the left one.
  const rightFootM = frames.right_foot_m && new Float32Array(buffer(frames.right_foot_m));
  const thrust = new Int16Array(buffer(frames.thrust));
  const joints = new Uint8Array(buffer(frames.joints));
  const pressed = new Uint8Array(buffer(frames.pressed));
  const states = new Uint8Array(buffer(frames.states));
  const count = times.length;
  const start = times[0];
  const end = times[count - 1];
  // The history ends before the fall that the page goes on to show.
  const historyEnd = data.end_s;
  const historyCount = times.filter((t) => t <= historyEnd).length;
  const STATES = ["at rest", "sways right", "sways left", "overturned"];
  const NO_THRUST = -32768;

  // ---- the state of the page ----
  let time = start;
  let playing = false;
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /** The frame before a time, and how far the time is on the way to the next: frames of other hinges do not blend. */
  function moment(t) {
    let low = 0;
    let high = count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t) low = middle;
      else high = middle - 1;
    }
    const next = Math.min(low + 1, count - 1);
    const blends = next > low && layoutOf[low] === layoutOf[next];
    const part = blends ? (t - times[low]) / (times[next] - times[low]) : 0;
    return { frame: low, next, part: Math.min(Math.max(part, 0), 1) };
  }

  const blend = (values, width, index, { frame, next, part }) =>
    values[frame * width + index] * (1 - part) + values[next * width + index] * part;

  /** Rotation and displacement of the origin of a body. */
  function pose(body, at) {
    return {
      rotation: blend(rotations, bodies, body, at) * frames.rotation_unit_rad,
      x: blend(shifts, 2 * bodies, 2 * body, at) * frames.shift_unit_m,
      y: blend(shifts, 2 * bodies, 2 * body + 1, at) * frames.shift_unit_m,
    };
  }

  /** Where a point of a body is, its displacement times the exaggeration. */
  function moved(body, x, y, poses, exaggeration) {
    if (body < 0) return [x, y];
    const { rotation, x: shiftX, y: shiftY } = poses[body];
    const cos = Math.cos(rotation);
    const sin = Math.sin(rotation);
    const nowX = cos * x - sin * y + shiftX;
    const nowY = sin * x + cos * y + shiftY;
    return [x + (nowX - x) * exaggeration, y + (nowY - y) * exaggeration];
  }

  /** A number with so many decimals, zero without a sign. */
  function fixed(value, decimals) {
    const text = value.toFixed(decimals);
    return Number(text) === 0 ? text.replace("-", "") : text;
  }

  const posesAt = (at) => Array.from({ length: bodies }, (_, body) => pose(body, at));

  // ---- the stage ----
  const stage = find("stage");
  const [low, high] = data.frame_m;
  const width = high[0] - low[0];
  const height = high[1] - low[1];
  const loaded = layouts.some(({ loads }) => loads.length > 0);

  /** A round number of metres between the marks of the rule. */
  function roundStep(rough) {
    const power = 10 ** Math.floor(Math.log10(rough));
    return power * [1, 2, 5, 10].find((digit) => digit * power >= rough);
  }

  const farthest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
  const groundX = Array.from({ length: count }, (_, i) => groundM[2 * i]);
  // A pulse may leave the ground with a velocity: where it goes far, the eye goes with it.
  find("ride").checked = farthest(groundX) > 0.1 * Math.max(width, height);

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const wide = stage.clientWidth || 800;
    const tall = stage.clientHeight || 400;
    if (stage.width !== Math.round(wide * ratio) || stage.height !== Math.round(tall * ratio)) {
      stage.width = Math.round(wide * ratio);
      stage.height = Math.round(tall * ratio);
    }
    const pen = stage.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const ink = css("--ink");
    const soft = css("--soft");
    pen.fillStyle = css("--paper");
    pen.fillRect(0, 0, wide, tall);
    const sizes = find("sizes").checked && data.dimensions.length > 0;
    const below = sizes ? 92 : 64;
    // Room beside the structure for its sway, and for its dimensions.
    const beside = Math.max(sizes ? 54 : 10, 0.1 * wide);
    const above = loaded ? 44 : 16;
    const scale = Math.min((wide - 2 * beside) / width, (tall - below - above) / (1.05 * height));
    const at = moment(time);
    const exaggeration = Number(find("exaggeration").value);
    const ground = [blend(groundM, 2, 0, at), blend(groundM, 2, 1, at)];
    const camera = find("ride").checked ? ground : [0, 0];
    const origin = [wide / 2 - (scale * (low[0] + high[0])) / 2, tall - below + scale * low[1]];
    const onScreen = ([x, y]) => [
      origin[0] + scale * (x + ground[0] - camera[0]),
      origin[1] - scale * (y + ground[1] - camera[1]),
    ];
    const path = (points, close) => {
      pen.beginPath();
      points.forEach((point, i) => (i ? pen.lineTo(...onScreen(point)) : pen.moveTo(...onScreen(point))));
      if (close) pen.closePath();
    };
    pen.lineWidth = 1;
    pen.font = "12px system-ui, sans-serif";
    pen.lineJoin = "round";

    // The rule, fixed in space.
    const step = roundStep(60 / scale);
    const left = camera[0] + (0 - origin[0]) / scale;
    const right = camera[0] + (wide - origin[0]) / scale;
    pen.fillStyle = soft;
    pen.textAlign = "center";
    for (let mark = Math.ceil(left / step); mark * step <= right; mark += 1) {
      const x = origin[0] + scale * (mark * step - camera[0]);
      pen.strokeStyle = css("--line");
      pen.beginPath();
      pen.moveTo(x, 0);
      pen.lineTo(x, tall - 22);
      pen.stroke();
      pen.fillText(`${Number((mark * step).toPrecision(6))} m`, x, tall - 8);
    }

    // The ground, which moves, hatched.
    const floor = onScreen([0, low[1]])[1];
    pen.fillStyle = css("--earth");
    pen.fillRect(0, floor, wide, 14);
    pen.strokeStyle = ink;
    pen.beginPath();
    pen.moveTo(0, floor);
    pen.lineTo(wide, floor);
    const hatch = 16;
    const phase = (((scale * (ground[0] - camera[0])) % hatch) + hatch) % hatch;
    for (let x = phase - hatch; x < wide + hatch; x += hatch) {
      pen.moveTo(x, floor + 14);
      pen.lineTo(x + 8, floor);
    }
    pen.stroke();
    if (sizes) drawSizes(pen, onScreen, floor);
    pen.strokeStyle = ink;
    const foot = [0, 1].map((axis) => (rightFootM ? exaggeration * blend(rightFootM, 2, axis, at) : 0));
    const [built, movedTo] = data.supports;
    const faces = built.map((face, i) => face.map((x, k) => x + (movedTo[i][k] - x) * exaggeration));
    faces.forEach(([ax, ay, bx, by], right) => {
      pen.lineWidth = 4;
      const [x, y] = foot.map((gone) => right * gone);
      path([[x + ax - 0.3 * (bx - ax), y + ay - 0.3 * (by - ay)], [x + bx + 0.3 * (bx - ax), y + by + 0.3 * (by - ay)]]);
      pen.stroke();
    });

    // The blocks: where they were, and where they are.
    const layout = layouts[layoutOf[at.frame]];
    const poses = posesAt(at);
    const point = ([body, x, y]) => moved(body, x, y, poses, exaggeration);
    const outline = (piece) => {
      const corners = [];
      for (let i = 0; i < piece.outline.length; i += 2) {
        corners.push([piece.body, piece.outline[i] * unitM, piece.outline[i + 1] * unitM]);
      }
      return corners;
    };
    const fills = bodies === 3 ? ["--left", "--middle", "--right"] : ["--stone", "--stone"];
    pen.lineWidth = 1;
    pen.setLineDash([4, 4]);
    pen.strokeStyle = soft;
    for (const piece of layout.pieces) {
      path(outline(piece).map(([, x, y]) => [x, y]), true);
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.strokeStyle = pen.fillStyle = css("--fill");
    pen.lineWidth = 1;
    for (const piece of layout.fill) {
      path(outline(piece).map(point), true);
      pen.fill();
      pen.stroke();
    }
    pen.strokeStyle = ink;
    pen.lineWidth = 1.3;
    for (const piece of layout.pieces) {
      pen.fillStyle = css(piece.body < 0 ? "--earth" : fills[piece.body % fills.length]);
      path(outline(piece).map(point), true);
      pen.fill();
      pen.stroke();
    }

    // Loads stand on their blocks.
    pen.strokeStyle = pen.fillStyle = css("--mark");
    pen.lineWidth = 2;
    pen.textAlign = "center";
    for (const [body, x, y, over, text] of layout.loads) {
      const [px, py] = onScreen(point([body, x, y]));
      pen.beginPath();
      pen.moveTo(px, py - 22);
      pen.lineTo(px, py - 2);
      pen.moveTo(px - 4, py - 8);
      pen.lineTo(px, py - 1);
      pen.lineTo(px + 4, py - 8);
      pen.moveTo(px - 0.5 * scale * over, py - 22);
      pen.lineTo(px + 0.5 * scale * over, py - 22);
      pen.stroke();
      pen.fillText(text, px, py - 27);
    }

    // The ties.
    pen.strokeStyle = css("--tie");
    data.ties.forEach((ends, tie) => {
      const broken = data.ties_broken_s[tie] !== null && times[at.frame] >= data.ties_broken_s[tie];
      const [from, to] = ends.map(point);
      const stub = ([x, y], [otherX, otherY]) => [x + 0.4 * (otherX - x), y + 0.4 * (otherY - y)];
      pen.lineWidth = broken ? 2 : 3;
      pen.setLineDash(broken ? [5, 4] : []);
      for (const line of broken ? [[from, stub(from, to)], [to, stub(to, from)]] : [[from, to]]) {
        path(line);
        pen.stroke();
      }
    });
    pen.setLineDash([]);

    // Where elastic joints press, and the stress there as a wedge.
    if (frames.largest_stress_pa) {
      pen.fillStyle = pen.strokeStyle = css("--press");
      data.joints.forEach(([body, ix, iy, ex, ey], joint) => {
        const { stresses, ends } = pressure(at.frame, joint);
        if (stresses.every((stress) => stress === 0)) return;
        const high = (0.6 * Math.hypot(ex - ix, ey - iy)) / frames.largest_stress_pa;
        const [acrossX, acrossY] = data.across[joint];
        const corner = (end, stress) => {
          const [part, up] = [ends[end], high * stress];
          return point([body, ix + part * (ex - ix) + up * acrossX, iy + part * (ey - iy) + up * acrossY]);
        };
        path([corner(0, 0), corner(0, stresses[0]), corner(1, stresses[1]), corner(1, 0)], true);
        pen.globalAlpha = 0.55;
        pen.fill();
        pen.globalAlpha = 1;
        pen.lineWidth = 3;
        path([corner(0, 0), corner(1, 0)], false);
        pen.stroke();
      });
    }

    // The line of thrust, where sections are pressed.
    if (find("thrust").checked && frames.thrust_unit) {
      pen.strokeStyle = css("--thrust");
      pen.lineWidth = 2.5;
      pen.beginPath();
      let drawing = false;
      sections.forEach(([middleX, middleY, acrossX, acrossY], i) => {
        const value = thrust[at.frame * sections.length + i];
        if (value === NO_THRUST) {
          drawing = false;
          return;
        }
        const e = value * frames.thrust_unit;
        const to = onScreen(point([layout.section_bodies[i], middleX + e * acrossX, middleY + e * acrossY]));
        if (drawing) pen.lineTo(...to);
        else pen.moveTo(...to);
        drawing = true;
      });
      pen.stroke();
    }

    // The hinges.
    pen.strokeStyle = css("--mark");
    pen.lineWidth = 2;
    for (const [body, x, y, edge] of hingesAt(at.frame)) {
      const [px, py] = onScreen(point([body, x, y]));
      pen.beginPath();
      if (edge === PARTED) {
        pen.moveTo(px - 4, py - 4);
        pen.lineTo(px + 4, py + 4);
        pen.moveTo(px - 4, py + 4);
        pen.lineTo(px + 4, py - 4);
      } else {
        pen.arc(px, py, 4, 0, 2 * Math.PI);
        pen.fillStyle = edge === EXTRADOS ? css("--mark") : css("--paper");
        pen.fill();
      }
      pen.stroke();
    }

    // The points that are watched.
    pen.strokeStyle = css("--mark");
    pen.fillStyle = css("--paper");
    pen.lineWidth = 2;
    (data.points ?? []).forEach(({ at_m: [x, y] }, i) => {
      const [px, py] = onScreen(point([layout.point_bodies[i], x, y]));
      pen.fillRect(px - 4, py - 4, 8, 8);
      pen.strokeRect(px - 4, py - 4, 8, 8);
    });

    // How the ground accelerates.
    const g = blend(groundG, 1, 0, at);
    const most = farthest(groundG);
    if (most > 0) {
      const length = (0.2 * wide * g) / most;
      const y = tall - 38;
      pen.strokeStyle = pen.fillStyle = css("--curve-2");
      pen.lineWidth = 3;
      pen.beginPath();
      pen.moveTo(wide / 2, y);
      pen.lineTo(wide / 2 + length, y);
      if (Math.abs(length) > 6) {
        const back = Math.sign(length) * 7;
        pen.moveTo(wide / 2 + length - back, y - 5);
        pen.lineTo(wide / 2 + length, y);
        pen.lineTo(wide / 2 + length - back, y + 5);
      }
      pen.stroke();
      pen.fillStyle = ink;
      pen.textAlign = g < 0 ? "left" : "right";
      pen.fillText(`ground ${fixed(g, 3)} g`, wide / 2 + (g < 0 ? 10 : -10), y + 4);
    }
    find("now").textContent = inWords(at, poses);
  }

  /** The dimensions of the structure at rest, outside it: heights left and right, widths below the ground. */
  function drawSizes(pen, onScreen, floor) {
    const [left, right] = [onScreen(low)[0], onScreen(high)[0]];
    pen.strokeStyle = pen.fillStyle = css("--soft");
    pen.lineWidth = 1;
    // Those that would be on another go one line farther.
    const taken = { below: [], left: [], right: [] };
    for (const { ends_m: [ax, ay, bx, by], side, text } of data.dimensions) {
      const [a, b] = [onScreen([ax, ay]), onScreen([bx, by])];
      const axis = side === "below" ? 0 : 1;
      const span = [a[axis], b[axis]].sort((x, y) => x - y);
      const lines = taken[side];
      let line = lines.findIndex((spans) => spans.every(([from, to]) => span[1] <= from + 1 || to <= span[0] + 1));
      if (line < 0) line = lines.push([]) - 1;
      lines[line].push(span);
      const at = side === "below" ? floor + 26 + 14 * line : side === "left" ? left - 16 - 16 * line : right + 16 + 16 * line;
      const foot = (end) => (axis === 0 ? [end[0], at] : [at, end[1]]);
      const ends = [foot(a), foot(b)];
      pen.beginPath();
      pen.moveTo(...ends[0]);
      pen.lineTo(...ends[1]);
      for (const [x, y] of ends) {
        pen.moveTo(x - 3, y + 3);
        pen.lineTo(x + 3, y - 3);
      }
      pen.stroke();
      pen.save();
      pen.textAlign = "center";
      pen.translate((ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2);
      if (axis === 1) pen.rotate(-Math.PI / 2);
      // On paper of its own, where the line would strike it through.
      const wide = pen.measureText(text).width + 6;
      if (axis === 0) {
        pen.fillStyle = css("--paper");
        pen.fillRect(-wide / 2, -6, wide, 12);
        pen.fillStyle = css("--soft");
        pen.fillText(text, 0, 4);
      } else {
        pen.fillText(text, 0, side === "left" ? -4 : 12);
      }
      pen.restore();
    }
  }

  const INTRADOS = 1;
  const EXTRADOS = 2;
  const PARTED = 3;

  /** The hinges that are open in a frame: body, place, and edge. */
  function hingesAt(frame) {
    const open = [];
    data.joints.forEach(([body, ix, iy, ex, ey], joint) => {
      const code = joints[frame * data.joints.length + joint];
      if (code === INTRADOS || code === PARTED) open.push([body, ix, iy, code]);
      if (code === EXTRADOS || code === PARTED) open.push([body, ex, ey, code]);
    });
    return open.concat(layouts[layoutOf[frame]].hinges);
  }

  /** Stresses at the ends of what presses of a joint, in Pa, and where those are, from 0 at the intrados to 1 at the extrados. */
  function pressure(frame, joint) {
    const first = 3 * (frame * data.joints.length + joint);
    const [inner, outer, contact] = Array.from(pressed.subarray(first, first + 3), (part) => part / 255);
    const stresses = [inner, outer].map((part) => part * frames.largest_stress_pa);
    const ends = outer === 0 ? [0, contact] : inner === 0 ? [1 - contact, 1] : [0, 1];
    return { stresses, ends };
  }

  function inWords(at, poses) {
    // Of several that turn as far, the one that the words name.
    let most = data.largest_body;
    poses.forEach(({ rotation }, body) => {
      if (Math.abs(rotation) > Math.abs(poses[most].rotation)) most = body;
    });
    const name = data.bodies[most];
    const of = name === "" ? "" : /^\d+$/.test(name) ? ` (block ${name})` : ` (${name})`;
    const open = data.joints.length
      ? data.joints.filter((_, joint) => joints[at.frame * data.joints.length + joint]).length
      : layouts[layoutOf[at.frame]].hinges.length;
    const falls = time > historyEnd ? " and falls" : "";
    const turned = `largest rotation ${fixed(poses[most].rotation, 5)} rad${of}`;
    return `${time.toFixed(3)} s: ${STATES[states[at.frame]]}${falls}, ${turned}, ${open} open ${open === 1 ? "hinge" : "hinges"}`;
  }

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
    // What never differs from zero would only take room.
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
            // What overturns leaves the plot, rather than making all else small.
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

  /** The legend of a plot: each curve with its value at the instant, or of many only some names. Returns what shows the values. */
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

  /** A curve at a time, straight between its points. */
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
  // The one that turns most is drawn above the others.
  const order = data.bodies.map((_, body) => body);
  if (!few) order.push(...order.splice(most, 1));
  const turning = order.map((body) => ({ ...look(body), values: turns[body] }));
  const named = few ? turning : [{ ...look(most), values: turns[most] }, { ...look((most + 1) % bodies), name: "other blocks" }];
  addPlot("Rotation (rad, anticlockwise)", 230, Array.from(times.subarray(0, historyCount)), turning, named);
  for (const { curves } of data.points ?? []) {
    // Each is thinned by itself, so that their times differ.
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
    // With reduced motion: four still pictures a second.
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

  /** So many frames on or back. */
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
  find("thrust").addEventListener("change", draw);
  find("ride").addEventListener("change", draw);
  find("sizes").addEventListener("change", draw);
  // What had turned far enough as it overturned has no fall to follow.
  find("fall").hidden = !data.fall_end || (end === historyEnd && data.fall_end.includes("45"));
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
  // On paper all is on one sheet: the structure and the plots share what the words leave.
  const SHEET_PX = { width: 715, height: 1030 };
  const LEAST_PX = { stage: 200, plot: 70 };
  // Title and legend of a plot.
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

  /** An exaggeration with which the displacements at an instant can be seen: a fifteenth of the size of the structure. */
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

  // It opens at the strongest instant.
  exaggerate(visible(moment(data.opens_s)));
  seek(data.opens_s);

  // For scripts: what the page shows, and ways to change it.
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
})();
