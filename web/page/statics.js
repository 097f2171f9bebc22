// Statics to touch: the thrust line follows the reaction of the left springing. Forces in N, points in metres, moments about the origin.

const plus = (a, b) => a.map((value, i) => value + b[i]);
const times = (factor, a) => a.map((value) => factor * value);
const minus = (a, b) => plus(a, times(-1, b));
const between = (part, a, b) => plus(times(1 - part, a), times(part, b));
const cross = ([ax, ay], [bx, by]) => ax * by - ay * bx;
/** Returns the moment about a point of a force with its moment about the origin. */
const momentAbout = (point, [x, y, moment]) => moment - cross(point, [x, y]);

/** Returns the loads between the left springing and each joint under a push: force and moment. */
function loadsBefore({ blocks }, push) {
  const loads = [[0, 0, 0]];
  for (const [centre, weight] of blocks) loads.push(plus(loads.at(-1), [push * weight, -weight, cross(centre, [push * weight, -weight])]));
  return loads;
}

/** Returns where resultants cross the first joints: 0 at the intrados, 1 at the extrados; without compression nowhere. */
function crossings({ joints }, reaction, loads) {
  return loads.map((load, joint) => {
    const [inside, outside] = joints[joint].map((corner) => momentAbout(corner, plus(reaction, load)));
    return outside > inside ? inside / (inside - outside) : NaN;
  });
}

/** Returns the reactions at a foot that keep the thrust line in the stone: the corners of a polygon of forces. */
function region({ joints }, foot, loads) {
  const far = 5 * loads.at(-1)[1];
  let polygon = [[far, far], [-far, far], [-far, -far], [far, -far]];
  joints.forEach((corners, joint) => corners.forEach((corner, edge) => {
    const margin = (force) => (2 * edge - 1) * (cross(minus(foot, corner), force) + momentAbout(corner, loads[joint]));
    polygon = polygon.flatMap((to, i) => {
      const from = polygon.at(i - 1);
      const [before, after] = [margin(from), margin(to)];
      const cut = before >= 0 === after >= 0 ? [] : [between(before / (before - after), from, to)];
      return after >= 0 ? [...cut, to] : cut;
    });
  }));
  return polygon;
}

/** Returns the only reaction under the push of a first motion: its thrust line passes through three hinges. */
function lastReaction(data, { acceleration_g, hinges }, sign) {
  const loads = loadsBefore(data, sign * acceleration_g);
  const rows = hinges.slice(0, 3).map(([joint, edge]) => {
    const [x, y] = data.joints[joint][edge];
    return [y, -x, 1, -momentAbout([x, y], loads[joint])];
  });
  const determinant = (...columns) => {
    const [a, b, c] = columns.map((column) => rows.map((row) => row[column]));
    return a[0] * cross(b.slice(1), c.slice(1)) - a[1] * cross([b[0], b[2]], [c[0], c[2]]) + a[2] * cross(b, c);
  };
  return [[3, 1, 2], [0, 3, 2], [0, 1, 3]].map((columns) => determinant(...columns) / determinant(0, 1, 2));
}

/** Returns a reaction that holds the arch under a push. Loads are linear: a mean of the last reactions to both sides holds the mean of their pushes. */
function holdingReaction({ last, pushes: [right, left] }, push) {
  return between((right - push) / (right - left), ...last);
}

const pathOf = (points, end = "") => (points.length > 0 ? `M${points.map((point) => point.join(" ")).join("L")}${end}` : "");
const kilo = (force_n) => Number((force_n / 1000).toPrecision(3));
const range = (values) => `${kilo(Math.min(...values))} to ${kilo(Math.max(...values))} kN`;
const set = (id, attributes) => Object.entries(attributes).forEach(([name, value]) => find(id).setAttribute(name, value));

/** The arch in hand: its data, the pushes of its first motions with their reactions, the push, and the reaction that the reader has set. */
let hand = null;

function footOf({ data, reaction }) {
  const [place] = crossings(data, reaction, [[0, 0, 0]]);
  return between(Math.min(Math.max(place || 0, 0), 1), ...data.joints[0]);
}
const forceOf = ({ reaction }) => reaction.slice(0, 2);
const tailOf = (arch) => minus(footOf(arch), times(arch.scale, forceOf(arch)));
/** Places of forces in the enlarged picture, whose middle holds the arch. */
const middle = () => holdingReaction(hand, hand.push).slice(0, 2);
const nearOf = (force) => times(100 / hand.spread, minus(force, middle()));

/** Returns the outlines of blocks after a small motion. */
function moved(outlines, velocities, largest_m) {
  const moves = outlines.map((outline, i) => outline.map(([x, y]) => plus(velocities[i][0], times(velocities[i][1], [-y, x]))));
  const factor = largest_m / Math.max(...moves.flat().map((move) => Math.hypot(...move)));
  return outlines.map((outline, i) => outline.map((corner, k) => plus(corner, times(factor, moves[i][k]))));
}

function drawStatics() {
  const { data, push, reaction, pushes } = hand;
  const loads = loadsBefore(data, push);
  const places = crossings(data, reaction, loads);
  const leaving = [...places.keys()].filter((joint) => !(Math.abs(places[joint] - 0.5) < 0.5 + 1e-9));
  const motion = data.first_motions.find((_, side) => Math.abs(push / pushes[side] - 1) < 1e-4);
  const open = motion?.hinges ?? leaving.map((joint) => [joint, places[joint] > 1 ? 1 : 0]);
  const held = region(data, footOf(hand), loads);
  const drawn = [...places.keys()].filter((joint) => Math.abs(places[joint]) < 5);
  const blocks = (outlines) => ({ d: outlines.map((outline) => pathOf(outline, "Z")).join("") });
  set("stones", blocks(data.outlines));
  set("moved", blocks(motion ? moved(data.outlines, motion.velocities, 0.05 * hand.width) : []));
  set("thrust-line", { d: pathOf(drawn.map((joint) => between(places[joint], ...data.joints[joint]))) });
  set("arrow", { d: pathOf([tailOf(hand), footOf(hand)]) });
  set("opened", { d: open.map(([joint, edge]) => `${pathOf([data.joints[joint][edge]])}h0`).join("") });
  set("held-region", { d: pathOf(held.map(nearOf), "Z") });
  const near = nearOf(forceOf(hand)).map((at) => Math.min(Math.max(at, -96), 96));
  for (const [id, [cx, cy]] of Object.entries({ foot: footOf(hand), tail: tailOf(hand), force: near })) set(id, { cx, cy });
  const joints = `${open.length > 1 ? "joints" : "joint"} ${open.slice(0, 6).map(([joint]) => joint).join(", ")}${open.length > 6 ? " and others" : ""}`;
  const bounds = held.length > 0 ? `From this foot, H from ${range(held.map(([x]) => x))} with V from ${range(held.map(([, y]) => y))} can hold it.` : "From this foot no reaction holds it.";
  const verdict = leaving.length === 0 ? "This reaction holds the arch: the thrust line stays in the stone." : `This reaction does not hold the arch: the thrust line leaves the stone at ${joints}.`;
  find("pushed").textContent = push ? `${Math.abs(push).toFixed(4)} g ${push < 0 ? "to the left" : "to the right"}` : "none";
  find("held").textContent = motion ? `Under this push, A_L, one reaction is left. Hinges open at ${joints}, and the arch moves.` : `${verdict} H = ${kilo(reaction[0])} kN, V = ${kilo(reaction[1])} kN. ${bounds}`;
}

function setReaction(reaction) {
  hand.reaction = reaction;
  drawStatics();
}

/** Takes an arch in hand, under no push. */
function takeInHand(data) {
  const pushes = data.first_motions.map(({ acceleration_g }, side) => (side === 0 ? 1 : -1) * acceleration_g);
  const last = data.first_motions.map((motion, side) => lastReaction(data, motion, Math.sign(pushes[side])));
  const [[left, right], [bottom, top]] = [0, 1].map((i) => data.outlines.flat().map((point) => point[i])).map((all) => [Math.min(...all), Math.max(...all)]);
  const width = right - left;
  const below = 0.45 * Math.max(top - bottom, 0.5 * width);
  hand = { data, pushes, last, push: 0, width };
  hand.reaction = holdingReaction(hand, 0);
  hand.scale = (0.8 * below) / Math.hypot(...forceOf(hand));
  const held = region(data, footOf(hand), loadsBefore(data, 0));
  hand.spread = 1.3 * Math.max(...held.flatMap((force) => minus(force, middle()).map(Math.abs)));
  set("at-rest", { viewBox: [left - 0.15 * width, -top - 0.1 * width, 1.3 * width, top - bottom + below + 0.1 * width].join(" ") });
  for (const id of ["foot", "tail"]) set(id, { r: 0.015 * width });
  Object.assign(find("push"), { min: pushes[1], max: pushes[0], value: 0 });
  drawStatics();
}

let askStatics;
/** Shows the statics of the scenario, if they are open. */
async function showStatics() {
  if (!find("statics").open || !askStatics) return;
  const answer = await askStatics(request({ statics: true }));
  if (!answer) return;
  find("touch").hidden = !answer.statics;
  if (answer.statics) takeInHand(answer.statics);
  else find("held").textContent = answer.errors[0]?.message ?? "For these statics the structure must be an arch of voussoirs, without ties, on springings that have not moved.";
}

const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** Moves a handle by pointer or by the arrow keys: `at` returns its place, `move` receives the new one. */
function makeGrip(id, at, move) {
  const grip = find(id);
  const svg = grip.closest("svg");
  grip.addEventListener("pointerdown", ({ pointerId }) => grip.setPointerCapture(pointerId));
  grip.addEventListener("pointermove", ({ pointerId, clientX, clientY }) => {
    if (!grip.hasPointerCapture(pointerId)) return;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(svg.getScreenCTM().inverse());
    move([x, -y]);
  });
  grip.addEventListener("keydown", (event) => {
    if (!STEPS[event.key]) return;
    event.preventDefault();
    move(plus(at(), times(svg.viewBox.baseVal.width / 200, STEPS[event.key])));
  });
}

const withForce = (force) => setReaction([...force, cross(footOf(hand), force)]);
makeGrip("foot", () => footOf(hand), (place) => {
  const [from, to] = hand.data.joints[0];
  const along = minus(to, from);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1];
  const part = dot(minus(place, from), along) / dot(along, along);
  setReaction([...forceOf(hand), cross(between(Math.min(Math.max(part, 0), 1), from, to), forceOf(hand))]);
});
makeGrip("tail", () => tailOf(hand), (place) => withForce(times(1 / hand.scale, minus(footOf(hand), place))));
makeGrip("force", () => nearOf(forceOf(hand)), (place) => withForce(plus(middle(), times(hand.spread / 100, place))));
const hold = () => setReaction(holdingReaction(hand, (hand.push = Number(find("push").value))));
find("push").addEventListener("input", hold);
find("hold").addEventListener("click", hold);
find("statics").addEventListener("toggle", showStatics);
