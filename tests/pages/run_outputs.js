// Runs beside the pages of several runs, each in a frame. `data` has what the tables and the words say of each.
const frames = [...document.querySelectorAll("iframe")];
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
for (const [index, told] of data.entries()) {
  for (let tries = 0; tries < 100 && !frames[index].contentWindow.archrock; tries += 1) await wait(50);
  const page = frames[index].contentWindow.archrock;
  const text = (id) => frames[index].contentDocument.getElementById(id).textContent;
  const where = `page ${index + 1}`;
  verify(text("outcome") === told.verdict, `${where}: ${text("outcome")}`);
  const words = frames[index].contentDocument.querySelector("div.words").textContent;
  verify(words.includes(told.happens), `${where}: ${words}`);
  const end = page.data.end_s;
  verify(end === told.end_s, `${where} ends at ${end}`);
  // At the largest rotation of the table: how far, which block, to which side. Frames may be thinned.
  const unit = page.data.frames.rotation_unit_rad;
  const frame = page.times.findIndex((time) => time >= told.peak_s - 1e-9);
  page.seek(page.times[frame]);
  const shown = page.shown();
  const turned = shown.poses.map(({ rotation }) => Math.abs(rotation));
  const most = Math.max(...turned);
  verify(Math.abs(most - told.peak_rad) <= unit + 0.02 * told.peak_rad, `${where} turns by ${most}, ${told.peak_rad}`);
  verify(turned[page.data.largest_body] >= most - unit - 1e-3 * most, `${where}: body ${page.data.largest_body}`);
  const states = { rest: "at rest", right: "sways right", left: "sways left", overturned: "overturned" };
  const same = Math.abs(page.times[frame] - told.peak_s) < 1e-9;
  if (same) verify(shown.state === states[told.state], `${where}: ${shown.state}, ${told.state}`);
  const now = text("now");
  verify(now.startsWith(`${page.times[frame].toFixed(3)} s: `), `${where}: ${now}`);
  const said = Number(/largest rotation (-?[0-9.]+) rad/.exec(now)[1]);
  verify(Math.abs(Math.abs(said) - most) <= 0.6e-5, `${where}: ${now}`);
}
