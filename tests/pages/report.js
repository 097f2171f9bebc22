// Runs in report.html. `data.rows` are rows of rotations.csv and poses.csv: time, state, and for each body rotation, x, y.
const report = window.archrock;
const find = (id) => document.getElementById(id);
const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance;
const units = report.data.frames;

// It opens at the strongest instant: the largest rotation, or where it can no longer come back.
{
  const { time, poses } = report.shown();
  const turned = Math.max(...poses.map(({ rotation }) => Math.abs(rotation)));
  if (data.overturned_s) verify(near(time, data.overturned_s, 1e-9), `opens at ${time}`);
  else verify(turned > 0.97 * data.largest_rad, `opens at ${turned} rad`);
  const times = Number(find("times").textContent);
  verify(times >= 1 && times <= 50, "exaggeration");
}
for (const plot of document.querySelectorAll(".plot")) {
  const legend = plot.querySelector(".legend").textContent;
  verify(/[a-z]/.test(legend) && /: -?[0-9]/.test(legend), `legend ${legend}`);
}

// Frames at given times are compared with the tables.
for (const { time_s, state, bodies } of data.rows) {
  report.seek(time_s);
  const shown = report.shown();
  verify(near(shown.time, time_s, 1e-12), `time ${time_s}`);
  verify(shown.state === { rest: "at rest", right: "sways right", left: "sways left", overturned: "overturned" }[state],
    `state at ${time_s}: ${shown.state}, ${state}`);
  bodies.forEach(([rotation, x, y], body) => {
    const pose = shown.poses[body];
    verify(near(pose.rotation, rotation, 0.51 * units.rotation_unit_rad), `rotation at ${time_s}: ${pose.rotation}, ${rotation}`);
    verify(near(pose.x, x, 0.51 * units.shift_unit_m), `x at ${time_s}: ${pose.x}, ${x}`);
    verify(near(pose.y, y, 0.51 * units.shift_unit_m), `y at ${time_s}: ${pose.y}, ${y}`);
  });
  verify(find("now").textContent.startsWith(`${time_s.toFixed(3)} s: ${shown.state}`), find("now").textContent);
}
verify(data.rows.length > 10, "rows");
verify(report.data.end_s === data.end_s && report.times.includes(data.end_s), "a frame is the end of the history");
const last = report.times[report.times.length - 1];
if (data.overturned_s) {
  // The fall goes on until a block has turned by 45 degrees.
  report.seek(last);
  const turned = Math.max(...report.shown().poses.map(({ rotation }) => Math.abs(rotation)));
  verify(last > data.end_s && turned >= Math.PI / 4 - units.rotation_unit_rad, `falls to ${turned}`);
  verify(find("now").textContent.includes("overturned and falls"), find("now").textContent);
  verify(!find("fall").hidden && find("fall-end").textContent.includes("45 degrees"), find("fall-end").textContent);
} else verify(last === data.end_s && find("fall").hidden, "no fall");

// The picture depends on the time only, and shows the open hinges.
const picture = () => find("stage").toDataURL();
report.seek(data.peak_s);
const atPeak = picture();
report.seek(0);
verify(picture() !== atPeak, "the picture changes");
report.seek(data.peak_s);
verify(picture() === atPeak, "the same time is the same picture");
verify(report.hingesAt(report.times.findIndex((t) => t >= data.peak_s - 1e-9)).length >= data.least_hinges, "open hinges");

// The slider, the box and the keys.
const slider = find("time");
slider.value = data.end_s / 2;
slider.dispatchEvent(new Event("input"));
verify(near(report.shown().time, data.end_s / 2, 1e-3), "the slider moves the time");
const press = (key, more) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, ...more }));
press("End");
verify(report.shown().time === last, "End");
press("Home");
verify(report.shown().time === 0, "Home");
press("ArrowRight");
verify(report.shown().time === report.times[1], "a frame on");
press("ArrowRight", { shiftKey: true });
verify(report.shown().time === report.times[11], "ten frames on");
press("ArrowLeft");
verify(report.shown().time === report.times[10], "a frame back");
report.seek(data.peak_s);
const small = picture();
find("exaggeration").value = 50;
find("exaggeration").dispatchEvent(new Event("input"));
verify(picture() !== small && find("times").textContent === "50", "exaggeration");
find("exaggeration").value = 1;
find("exaggeration").dispatchEvent(new Event("input"));
const without = picture();
press("t");
verify(!find("thrust-choice").hidden && find("thrust").checked && picture() !== without, "the thrust line");
// Under a pulse that brings the ground back, it is away half way.
report.seek(data.end_s / 2);
const ridden = picture();
find("ride").click();
verify(picture() !== ridden, "riding with the ground or not");

// Plots: the cursor is at the current time, a click moves it, all plots zoom together.
const plots = document.querySelectorAll(".u-over");
verify(plots.length >= 3, "plots");
const wide = plots[0].getBoundingClientRect().width;
const at = { clientX: plots[1].getBoundingClientRect().left + 0.25 * wide, bubbles: true };
for (const kind of ["mousemove", "mousedown", "mouseup", "click"]) plots[1].dispatchEvent(new MouseEvent(kind, at));
verify(near(report.shown().time, 0.25 * data.end_s, 0.01 * data.end_s), "a click on a plot");
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
await wait(50);
for (const plot of plots) {
  verify(near(parseFloat(plot.querySelector(".instant").style.left), 0.25 * wide, 2), "the instant");
}
press("+");
await wait(50);
for (const [from, to] of report.range()) verify(near(to - from, data.end_s / 1.5, 1e-6), "zoom");
press("0");
await wait(50);
for (const [from, to] of report.range()) verify(from === 0 && to === data.end_s, "all");

// Playing advances the time; with reduced motion it does so in steps.
report.seek(0);
find("speed").value = "0.5";
find("play").click();
verify(report.shown().playing && find("play").textContent === "Pause", "plays");
await wait(1000);
const reached = report.shown().time;
verify(reached > 0.3 && reached < 0.7, `half a second later: ${reached}`);
press(" ");
verify(!report.shown().playing, "pauses");
await wait(300);
verify(report.shown().time === reached, "stays");

// Nothing is fetched.
verify(performance.getEntriesByType("resource").length === 0, "no other files");
