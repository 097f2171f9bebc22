// A structure in motion, drawn on a canvas.
const STATES = ["at rest", "sways right", "sways left", "overturned"];
// Codes of a section without compression, and of an open joint.
const NO_THRUST = -32768;
const [INTRADOS, EXTRADOS, PARTED] = [1, 2, 3];

/**
 * Makes a stage: functions that draw a motion, and its times.
 * `motion` has lengths in metres, times in seconds and angles in radians: `frames` (encoded numbers of all frames), `end_s` of the history, the
 * structure (`bodies`, `largest_body`, `standing_rad`, `unit_m`, `frame_m`, `dimensions`, `supports`, `ties`, `ties_broken_s`, `sections`, `joints`, `across`,
 * `points`), and its `layouts` of outlines, fill, loads and hinges.
 */
function createStage(canvas, motion) {
  const { frames, layouts, sections, unit_m: unitM } = motion;
  const bodies = motion.bodies.length;

  // Poses of the bodies, and the layout of each frame.
  const times = new Float64Array(buffer(frames.times_s));
  const rotations = new Int16Array(buffer(frames.rotations));
  const shifts = new Int16Array(buffer(frames.shifts));
  const layoutOf = new Uint16Array(buffer(frames.layouts));
  const groundM = new Float32Array(buffer(frames.ground_m));
  const groundG = new Float32Array(buffer(frames.ground_g));
  // Displacement of the right foot relative to the left one; null if both feet move together.
  const rightFootM = frames.right_foot_m && new Float32Array(buffer(frames.right_foot_m));
  const thrust = new Int16Array(buffer(frames.thrust));
  const joints = new Uint8Array(buffer(frames.joints));
  const pressed = new Uint8Array(buffer(frames.pressed));
  const states = new Uint8Array(buffer(frames.states));
  const count = times.length;
  const start = times[0];
  const end = times[count - 1];
  // End of the history. The fall after it is shown as well.
  const historyEnd = motion.end_s;
  const historyCount = times.filter((t) => t <= historyEnd).length;

  /** Returns the frame before time t, the next frame, and the fraction of the interval between both; 0 if their hinges differ. */
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

  /** Returns the rotation of a body and the displacement of its origin. */
  function pose(body, at) {
    return {
      rotation: blend(rotations, bodies, body, at) * frames.rotation_unit_rad,
      x: blend(shifts, 2 * bodies, 2 * body, at) * frames.shift_unit_m,
      y: blend(shifts, 2 * bodies, 2 * body + 1, at) * frames.shift_unit_m,
    };
  }

  /** Returns the position of a point of a body, with its displacement times the exaggeration. */
  function moved(body, x, y, poses, exaggeration) {
    if (body < 0) return [x, y];
    const { rotation, x: shiftX, y: shiftY } = poses[body];
    const cos = Math.cos(rotation);
    const sin = Math.sin(rotation);
    const nowX = cos * x - sin * y + shiftX;
    const nowY = sin * x + cos * y + shiftY;
    return [x + (nowX - x) * exaggeration, y + (nowY - y) * exaggeration];
  }

  /** Formats a number with this many decimals; zero has no sign. */
  function fixed(value, decimals) {
    const text = value.toFixed(decimals);
    return Number(text) === 0 ? text.replace("-", "") : text;
  }

  const posesAt = (at) => Array.from({ length: bodies }, (_, body) => pose(body, at));

  const [low, high] = motion.frame_m;
  const width = high[0] - low[0];
  const height = high[1] - low[1];
  const loaded = layouts.some(({ loads }) => loads.length > 0);

  /** Returns a round interval between the marks of the scale, in metres. */
  function roundStep(rough) {
    const power = 10 ** Math.floor(Math.log10(rough));
    return power * [1, 2, 5, 10].find((digit) => digit * power >= rough);
  }

  const groundX = Array.from({ length: count }, (_, i) => groundM[2 * i]);
  // After a pulse the ground may keep a velocity.
  const goesFar = farthest(groundX) > 0.1 * Math.max(width, height);

  /** Draws an instant, and returns it in words. `view`: factor on displacements, thrust line, dimensions, view that moves with the ground. */
  function draw(time, { exaggeration, hasThrust, hasSizes, rides }) {
    const ratio = window.devicePixelRatio || 1;
    const [wide, tall] = [canvas.clientWidth || 800, canvas.clientHeight || 400];
    const inDots = [wide, tall].map((length) => Math.round(length * ratio));
    if (canvas.width !== inDots[0] || canvas.height !== inDots[1]) [canvas.width, canvas.height] = inDots;
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.fillStyle = css("--paper");
    pen.fillRect(0, 0, wide, tall);
    const sizes = hasSizes && motion.dimensions.length > 0;
    const below = sizes ? 92 : 64;
    // Space beside the structure for its sway and its dimensions.
    const beside = Math.max(sizes ? 54 : 10, 0.1 * wide);
    const above = loaded ? 44 : 16;
    const scale = Math.min((wide - 2 * beside) / width, (tall - below - above) / (1.05 * height));
    const at = moment(time);
    const ground = [blend(groundM, 2, 0, at), blend(groundM, 2, 1, at)];
    const camera = rides ? ground : [0, 0];
    const origin = [wide / 2 - (scale * (low[0] + high[0])) / 2, tall - below + scale * low[1]];
    const onScreen = ([x, y]) => [
      origin[0] + scale * (x + ground[0] - camera[0]),
      origin[1] - scale * (y + ground[1] - camera[1]),
    ];
    pen.font = "12px system-ui, sans-serif";
    pen.lineJoin = "round";
    const trace = tracer(pen);
    const lineOf = (look, ...lines) => trace(look, ...lines.map((line) => line.map(onScreen)));

    // The scale, fixed in space.
    const step = roundStep(60 / scale);
    const left = camera[0] + (0 - origin[0]) / scale;
    const right = camera[0] + (wide - origin[0]) / scale;
    pen.fillStyle = css("--soft");
    pen.textAlign = "center";
    for (let mark = Math.ceil(left / step); mark * step <= right; mark += 1) {
      const x = origin[0] + scale * (mark * step - camera[0]);
      trace({ stroke: "--line" }, [[x, 0], [x, tall - 22]]);
      pen.fillText(`${Number((mark * step).toPrecision(6))} m`, x, tall - 8);
    }

    // The moving ground, hatched.
    const floor = onScreen([0, low[1]])[1];
    pen.fillStyle = css("--earth");
    pen.fillRect(0, floor, wide, 14);
    const hatch = 16;
    const phase = (((scale * (ground[0] - camera[0])) % hatch) + hatch) % hatch;
    const hatches = [[[0, floor], [wide, floor]]];
    for (let x = phase - hatch; x < wide + hatch; x += hatch) hatches.push([[x, floor + 14], [x + 8, floor]]);
    trace({ stroke: "--ink" }, ...hatches);
    if (sizes) drawSizes(pen, onScreen, floor);
    const foot = [0, 1].map((axis) => (rightFootM ? exaggeration * blend(rightFootM, 2, axis, at) : 0));
    const [built, movedTo] = motion.supports;
    const faces = built.map((face, i) => face.map((x, k) => x + (movedTo[i][k] - x) * exaggeration));
    faces.forEach(([ax, ay, bx, by], right) => {
      const [x, y] = foot.map((gone) => right * gone);
      const end = (part) => [x + ax + part * (bx - ax), y + ay + part * (by - ay)];
      lineOf({ stroke: "--ink", width: 4 }, [end(-0.3), end(1.3)]);
    });

    // The blocks: undeformed (dashed) and displaced.
    const layout = layouts[layoutOf[at.frame]];
    const poses = posesAt(at);
    const point = ([body, x, y]) => moved(body, x, y, poses, exaggeration);
    const outline = ({ body, outline }) =>
      Array.from({ length: outline.length / 2 }, (_, i) => [body, outline[2 * i] * unitM, outline[2 * i + 1] * unitM]);
    const fills = bodies === 3 ? ["--left", "--middle", "--right"] : ["--stone"];
    for (const piece of layout.pieces) {
      lineOf({ stroke: "--soft", dash: [4, 4], close: true }, outline(piece).map(([, x, y]) => [x, y]));
    }
    for (const piece of layout.fill) lineOf({ fill: "--fill", stroke: "--fill" }, outline(piece).map(point));
    // A column has no supports: its only piece that stands still is the wall behind it.
    const still = motion.supports[0].length > 0 ? "--earth" : "--wall";
    for (const piece of layout.pieces) {
      const fill = piece.body < 0 ? still : fills[piece.body % fills.length];
      lineOf({ fill, stroke: "--ink", width: 1.3 }, outline(piece).map(point));
    }

    // The loads on their blocks.
    pen.textAlign = "center";
    for (const [body, x, y, over, text, sideways] of layout.loads) {
      const [px, py] = onScreen(point([body, x, y]));
      if (sideways !== 0) {
        const back = (by) => px - sideways * by;
        trace({ stroke: "--mark", width: 2 }, [[back(30), py], [back(2), py]], [[back(8), py - 4], [back(1), py], [back(8), py + 4]]);
        pen.fillStyle = css("--mark");
        // A wall at the tail leaves no space there: the label is beyond the other face.
        const behind = (piece) => still === "--wall" && piece.body < 0 && piece.outline[0] * unitM * sideways < x * sideways;
        const moving = layout.pieces.filter((piece) => piece.body >= 0).flatMap((piece) => outline(piece).map(point));
        const face = Math.max(...moving.map((corner) => onScreen(corner)[0] * sideways)) * sideways;
        const isBeyond = layout.pieces.some(behind);
        pen.textAlign = sideways > 0 === isBeyond ? "left" : "right";
        pen.fillText(text, isBeyond ? face + 6 * sideways : back(34), py + 4);
        pen.textAlign = "center";
        continue;
      }
      const half = 0.5 * scale * over;
      const barbs = [[px - 4, py - 8], [px, py - 1], [px + 4, py - 8]];
      trace({ stroke: "--mark", width: 2 }, [[px, py - 22], [px, py - 2]], barbs, [[px - half, py - 22], [px + half, py - 22]]);
      pen.fillStyle = css("--mark");
      pen.fillText(text, px, py - 27);
    }

    // The ties.
    motion.ties.forEach((ends, tie) => {
      const broken = motion.ties_broken_s[tie] !== null && times[at.frame] >= motion.ties_broken_s[tie];
      const [from, to] = ends.map(point);
      const stub = ([x, y], [otherX, otherY]) => [x + 0.4 * (otherX - x), y + 0.4 * (otherY - y)];
      if (broken) lineOf({ stroke: "--tie", width: 2, dash: [5, 4] }, [from, stub(from, to)], [to, stub(to, from)]);
      else lineOf({ stroke: "--tie", width: 3 }, [from, to]);
    });

    // Compressed parts of elastic joints, with the stress as a wedge.
    for (let joint = 0; frames.largest_stress_pa && joint < motion.joints.length; joint += 1) {
      const [body, ix, iy, ex, ey] = motion.joints[joint];
      const { stresses, ends } = pressure(at.frame, joint);
      if (stresses.every((stress) => stress === 0)) continue;
      const high = (0.6 * Math.hypot(ex - ix, ey - iy)) / frames.largest_stress_pa;
      const [acrossX, acrossY] = motion.across[joint];
      const corner = (end, stress) => {
        const [part, up] = [ends[end], high * stress];
        return point([body, ix + part * (ex - ix) + up * acrossX, iy + part * (ey - iy) + up * acrossY]);
      };
      pen.globalAlpha = 0.55;
      lineOf({ fill: "--press" }, [corner(0, 0), corner(0, stresses[0]), corner(1, stresses[1]), corner(1, 0)]);
      pen.globalAlpha = 1;
      lineOf({ stroke: "--press", width: 3 }, [corner(0, 0), corner(1, 0)]);
    }

    // The thrust line through compressed sections.
    if (hasThrust && frames.thrust_unit) {
      const stretches = [[]];
      sections.forEach(([middleX, middleY, acrossX, acrossY], i) => {
        const value = thrust[at.frame * sections.length + i];
        const e = value * frames.thrust_unit;
        if (value === NO_THRUST) stretches.push([]);
        else stretches.at(-1).push(point([layout.section_bodies[i], middleX + e * acrossX, middleY + e * acrossY]));
      });
      lineOf({ stroke: "--thrust", width: 2.5 }, ...stretches);
    }

    // The hinges and the observed points.
    const mark = { stroke: "--mark", width: 2 };
    for (const [body, x, y, edge] of hingesAt(at.frame)) {
      const [px, py] = onScreen(point([body, x, y]));
      if (edge === PARTED) {
        trace(mark, [[px - 4, py - 4], [px + 4, py + 4]], [[px - 4, py + 4], [px + 4, py - 4]]);
        continue;
      }
      pen.beginPath();
      pen.arc(px, py, 4, 0, 2 * Math.PI);
      paint(pen, { ...mark, fill: edge === EXTRADOS ? "--mark" : "--paper" });
    }
    (motion.points ?? []).forEach(({ at_m: [x, y] }, i) => {
      const [px, py] = onScreen(point([layout.point_bodies[i], x, y]));
      trace({ ...mark, fill: "--paper" }, [[px - 4, py - 4], [px + 4, py - 4], [px + 4, py + 4], [px - 4, py + 4]]);
    });

    // The acceleration of the ground.
    const g = blend(groundG, 1, 0, at);
    const most = farthest(groundG);
    if (most > 0) {
      const y = tall - 38;
      const tip = wide / 2 + (0.2 * wide * g) / most;
      const back = tip - Math.sign(g) * 7;
      const barbs = Math.abs(tip - wide / 2) > 6 ? [[back, y - 5], [tip, y], [back, y + 5]] : [];
      trace({ stroke: "--curve-2", width: 3 }, [[wide / 2, y], [tip, y]], barbs);
      pen.fillStyle = css("--ink");
      pen.textAlign = g < 0 ? "left" : "right";
      pen.fillText(`ground ${fixed(g, 3)} g`, wide / 2 + (g < 0 ? 10 : -10), y + 4);
    }
    if (exaggeration > 1) {
      pen.fillStyle = css("--soft");
      pen.textAlign = "left";
      pen.fillText(`movement drawn ${exaggeration} times as large`, 8, 16);
    }
    return inWords(time, at, poses);
  }

  /** Fills the path of a pen, then strokes it. */
  function paint(pen, { fill, stroke, width = 1, dash = [] }) {
    if (fill) {
      pen.fillStyle = css(fill);
      pen.fill();
    }
    if (!stroke) return;
    pen.strokeStyle = css(stroke);
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.stroke();
  }

  /** Returns a function that draws lines through points on the screen as one path; filled lines are closed. */
  const tracer = (pen) => (look, ...lines) => {
    pen.beginPath();
    for (const line of lines) {
      line.forEach((point, i) => (i ? pen.lineTo(...point) : pen.moveTo(...point)));
      if (look.fill || look.close) pen.closePath();
    }
    paint(pen, look);
  };

  /** Draws the dimensions of the undeformed structure around it: heights left and right, widths below the ground. */
  function drawSizes(pen, onScreen, floor) {
    const [left, right] = [onScreen(low)[0], onScreen(high)[0]];
    // A dimension that would overlap another one moves one line outwards.
    const taken = { below: [], left: [], right: [] };
    for (const { ends_m: [ax, ay, bx, by], side, text } of motion.dimensions) {
      const axis = side === "below" ? 0 : 1;
      const ends = [onScreen([ax, ay]), onScreen([bx, by])];
      const span = ends.map((end) => end[axis]).sort((x, y) => x - y);
      const lines = taken[side];
      let line = lines.findIndex((spans) => spans.every(([from, to]) => span[1] <= from + 1 || to <= span[0] + 1));
      if (line < 0) line = lines.push([]) - 1;
      lines[line].push(span);
      const places = { below: floor + 26 + 14 * line, left: left - 16 - 16 * line, right: right + 16 + 16 * line };
      for (const end of ends) end[1 - axis] = places[side];
      const ticks = ends.map(([x, y]) => [[x - 3, y + 3], [x + 3, y - 3]]);
      tracer(pen)({ stroke: "--soft" }, ends, ...ticks);
      pen.save();
      pen.textAlign = "center";
      pen.translate((ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2);
      if (axis === 1) pen.rotate(-Math.PI / 2);
      else {
        // A background keeps the line from crossing the text.
        const wide = pen.measureText(text).width + 6;
        pen.fillStyle = css("--paper");
        pen.fillRect(-wide / 2, -6, wide, 12);
      }
      pen.fillStyle = css("--soft");
      pen.fillText(text, 0, { below: 4, left: -4, right: 12 }[side]);
      pen.restore();
    }
  }

  /** Returns the open hinges of a frame: body, position, and edge. */
  function hingesAt(frame) {
    const open = [];
    motion.joints.forEach(([body, ix, iy, ex, ey], joint) => {
      const code = joints[frame * motion.joints.length + joint];
      if (code === INTRADOS || code === PARTED) open.push([body, ix, iy, code]);
      if (code === EXTRADOS || code === PARTED) open.push([body, ex, ey, code]);
    });
    return open.concat(layouts[layoutOf[frame]].hinges);
  }

  /** Returns the stresses in Pa at the ends of the closed part of a joint, and the positions of these ends, from 0 at the intrados to 1 at the extrados. */
  function pressure(frame, joint) {
    const first = 3 * (frame * motion.joints.length + joint);
    const [inner, outer, contact] = Array.from(pressed.subarray(first, first + 3), (part) => part / 255);
    const stresses = [inner, outer].map((part) => part * frames.largest_stress_pa);
    const ends = outer === 0 ? [0, contact] : inner === 0 ? [1 - contact, 1] : [0, 1];
    return { stresses, ends };
  }

  function inWords(time, at, poses) {
    // If several bodies have the largest rotation, the printed words name this one.
    let most = motion.largest_body;
    const turned = poses.map(({ rotation }, body) => rotation - motion.standing_rad[body]);
    turned.forEach((rotation, body) => {
      if (Math.abs(rotation) > Math.abs(turned[most])) most = body;
    });
    const name = motion.bodies[most];
    const of = name === "" ? "" : /^\d+$/.test(name) ? ` (block ${name})` : ` (${name})`;
    const open = motion.joints.length
      ? motion.joints.filter((_, joint) => joints[at.frame * motion.joints.length + joint]).length
      : layouts[layoutOf[at.frame]].hinges.length;
    const falls = time > historyEnd ? " and falls" : "";
    const rotation = `largest rotation ${fixed(turned[most], 5)} rad${of}`;
    return `${time.toFixed(3)} s: ${STATES[states[at.frame]]}${falls}, ${rotation}, ${open} open ${open === 1 ? "hinge" : "hinges"}`;
  }

  /** Returns the exaggeration at which the largest displacement is a fifteenth of the size of the structure. */
  function visible(time) {
    const at = moment(time);
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

  const poses = (t) => posesAt(moment(t));
  const state = (t) => STATES[states[moment(t).frame]];
  const frame = (t) => moment(t).frame;
  /** Returns the rotation of a body over the history, relative to its position at rest. */
  const turns = (body) =>
    Array.from({ length: historyCount }, (_, i) => rotations[i * bodies + body] * frames.rotation_unit_rad - motion.standing_rad[body]);
  return { times, start, end, historyEnd, historyCount, goesFar, draw, visible, poses, state, frame, turns, hingesAt, pressure };
}
