// The page to try. The text of the scenario is its state: controls change it, and each change is computed in a worker.
const find = (id) => document.getElementById(id);
const MOST_BYTES = 16 << 20;
/** Names and contents of the record files that the reader has added. */
const files = {};

// Workers.

/** Compiles the module, which is inside this page or beside it. */
async function compile() {
  const inside = document.querySelector("#module");
  if (!inside) return WebAssembly.compile(await (await fetch("archrock.wasm")).arrayBuffer());
  const packed = Uint8Array.from(atob(inside.textContent.trim()), (c) => c.charCodeAt(0));
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(plain).arrayBuffer());
}

const workerAddress = URL.createObjectURL(new Blob([find("worker").textContent], { type: "text/javascript" }));

/** Makes a queue of one request at work and the newest one waiting. `status`, `bar` and `stop` show long work. */
function createQueue(module, status, bar, stop) {
  let worker = null;
  let work = null;
  let waiting = null;

  function finish(answer) {
    clearTimeout(work.timer);
    const done = work;
    work = null;
    bar.hidden = stop.hidden = true;
    status.textContent = "";
    done.resolve(answer);
    if (!work && waiting) begin(waiting);
  }

  function begin(next) {
    waiting = null;
    work = next;
    work.began = performance.now();
    if (!worker) {
      worker = new Worker(workerAddress);
      worker.onmessage = ({ data }) => (data.answer ? finish(data.answer) : show(data));
      worker.onerror = (event) => halt({ errors: [{ message: `the worker failed: ${event.message}` }], files: {} });
      worker.postMessage(module);
    }
    worker.postMessage(work.request);
    work.timer = setTimeout(() => ((stop.hidden = false), (status.textContent = "Computing…")), 400);
  }

  function show({ done, all }) {
    if (!work || stop.hidden) return;
    bar.hidden = false;
    bar.value = all > 0 ? done / all : 0;
    const left = ((performance.now() - work.began) / 1000) * (all / Math.max(done, 1) - 1);
    const rest = left < 90 ? `${Math.ceil(left)} s` : `${Math.ceil(left / 60)} min`;
    status.textContent = done >= all ? "Repeating with other steps…" : `Computing: ${Math.floor((100 * done) / all)} %, some ${rest} left`;
  }

  /** Ends the work with this answer; `null` means that nobody waits for it. */
  function halt(answer) {
    worker?.terminate();
    worker = null;
    if (work) finish(answer);
  }

  stop.addEventListener("click", () => {
    halt(null);
    status.textContent = "Stopped. Any change computes again.";
  });

  /** Returns the answer to a request; null if a newer one has replaced it or it was stopped. */
  return function ask(request) {
    return new Promise((resolve) => {
      waiting?.resolve(null);
      waiting = { request, resolve };
      if (!work) begin(waiting);
      // A reader who goes on waits neither for repetitions nor for long work.
      else if (work.request.no_repeat === false || performance.now() - work.began > 1000) halt(null);
    });
  };
}

// Pages of results, each in a frame.

/** Shows pages in a holder. A page like the last one, as of the next history, is shown in its frame. */
function createFrames(holder, title) {
  let frame = null;
  let observer = null;
  /** The boxes that the reader has changed, with their states. */
  const choices = {};

  /** Replaces the contents of the frame by those of a page with the same styles and libraries. */
  async function renew(html) {
    const inside = frame.contentWindow;
    const next = new DOMParser().parseFromString(html, "text/html");
    // The page answers its reader in between.
    await new Promise((resolve) => setTimeout(resolve));
    const plays = inside.archrock.shown().playing;
    inside.archrock.leave();
    for (const part of ["header", "main", "#data"]) inside.document.querySelector(part).replaceWith(next.querySelector(part));
    inside.eval([...next.scripts].at(-1).text);
    for (const [id, checked] of Object.entries(choices)) {
      const box = inside.document.getElementById(id);
      if (box.checked !== checked) box.click();
    }
    if (plays) inside.archrock.play(true);
  }

  return {
    inside: () => frame?.contentWindow,
    show(html) {
      if (frame?.contentWindow.archrock?.leave) return renew(html);
      const next = document.createElement("iframe");
      Object.assign(next, { className: "waiting", title, scrolling: "no", srcdoc: html });
      holder.querySelectorAll(".waiting").forEach((other) => other.remove());
      holder.append(next);
      return new Promise((resolve) => {
        next.onload = () => {
          const root = next.contentDocument.documentElement;
          const fit = () => (next.style.height = `${Math.ceil(root.getBoundingClientRect().height) + 2}px`);
          root.style.overflow = "hidden";
          root.addEventListener("change", ({ target }) => target.type === "checkbox" && (choices[target.id] = target.checked));
          next.classList.remove("waiting");
          observer?.disconnect();
          frame?.remove();
          frame = next;
          observer = new ResizeObserver(fit);
          observer.observe(root);
          resolve();
        };
      });
    },
  };
}

// The form.

function fill(select, choices) {
  for (const [name, label] of choices) select.append(new Option(label, name));
}

/** Returns the value of a key in the scenario as JSON. */
const valueOf = (scenario, key) => key.split(".").reduce((table, name) => table?.[name], scenario);

function createSlider([key, label, from, to, step]) {
  const row = document.createElement("div");
  row.className = "slider";
  const number = Object.assign(document.createElement("input"), { type: "number", step, id: `number-${key}` });
  const range = Object.assign(document.createElement("input"), { type: "range", min: from, max: to, step });
  const name = Object.assign(document.createElement("label"), { htmlFor: number.id, textContent: label });
  range.setAttribute("aria-label", label);
  row.append(name, number, range);
  const change = (value) => value !== "" && edit(withValue(find("text").value, key, String(Number(value))));
  range.addEventListener("input", () => change((number.value = range.value)));
  number.addEventListener("input", () => change((range.value = number.value)));
  return {
    row,
    key,
    show(scenario) {
      const value = valueOf(scenario, key);
      row.hidden = value === undefined || value === null;
      if (row.hidden || row.contains(document.activeElement)) return;
      // A value beyond the range widens it.
      range.min = Math.min(from, value);
      range.max = Math.max(to, value);
      range.value = number.value = value;
    },
  };
}

const sliders = Object.entries(SLIDERS).flatMap(([part, all]) => {
  const holder = document.querySelector(`[data-part="${part}"]`);
  const made = all.map(createSlider);
  holder.append(...made.map(({ row }) => row));
  return made;
});

const friction = Object.assign(document.createElement("label"), { className: "switch", textContent: " joints may slip" });
const slips = Object.assign(document.createElement("input"), { type: "checkbox" });
friction.prepend(slips);
document.querySelector('[data-part="model"]').append(friction);
slips.addEventListener("change", () => edit(withValue(find("text").value, `${find("model").value}.friction_coefficient`, slips.checked ? 0.6 : null)));

fill(find("structure"), STRUCTURES);
fill(find("ground"), PULSES);
fill(find("model"), MODELS);
const onlyRead = (select, name) => {
  const known = [...select.options].some((option) => option.value === name);
  select.querySelector(".other")?.remove();
  if (!known) select.append(Object.assign(new Option(name || "none", name), { className: "other" }));
  select.value = name;
};

find("structure").addEventListener("change", () => {
  const [, , table] = STRUCTURES.find(([name]) => name === find("structure").value);
  const old = STRUCTURES.map(([name]) => name).concat("basket_arch", "blocks", "piers", "piers.left", "piers.right", "fill", "load", "tie", "column.back");
  edit(withTable(find("text").value, old, table));
});
find("ground").addEventListener("change", () => {
  const text = find("text").value;
  const old = tableNames(text).filter((name) => name.startsWith("ground"));
  const motion = valueOf(last.scenario, `ground.${last.ground}`) ?? {};
  const { amplitude_g: amplitude = -0.3, duration_s: duration = 0.3 } = motion;
  edit(withTable(text, old, `[ground.${find("ground").value}]\namplitude_g = ${amplitude}\nduration_s = ${duration}\n`));
});
find("model").addEventListener("change", () => {
  const [, , table] = MODELS.find(([name]) => name === find("model").value);
  const text = find("text").value;
  const needsBlocks = table && tableNames(text).includes("arch") && !last.scenario.arch?.voussoirs;
  const cut = needsBlocks ? withValue(text, "arch.voussoirs", 36) : text;
  edit(withTable(cut, ["free_hinges", "elastic_joints", "impact"], table));
});

/** The last valid scenario, and the name of its ground motion. */
const last = { scenario: {}, ground: "" };

function showScenario(scenario) {
  last.scenario = scenario;
  last.ground = Object.keys(scenario.ground ?? {}).find((name) => name !== "right") ?? "";
  const has = (name) => scenario[name] !== undefined;
  const kinds = STRUCTURES.map(([name]) => name).concat("basket_arch", "blocks");
  onlyRead(find("structure"), kinds.find(has) ?? "");
  onlyRead(find("ground"), last.ground);
  const model = ["free_hinges", "elastic_joints"].find(has) ?? "";
  onlyRead(find("model"), model);
  friction.hidden = !model;
  slips.checked = Boolean(model && scenario[model].friction_coefficient);
  for (const slider of sliders) slider.show(scenario);
}

// Records.

async function addRecord(file) {
  if (!file) return;
  if (file.size > MOST_BYTES) {
    showErrors([{ message: `${file.name} has ${(file.size / 1048576).toFixed(0)} MB; this page takes records of at most 16 MB: use the program, or cut the file` }]);
    return;
  }
  files[file.name] = await file.text();
  const text = find("text").value;
  const old = tableNames(text).filter((name) => name.startsWith("ground"));
  edit(withTable(text, old, `[ground.record]\nfile = ${JSON.stringify(file.name)}\nscale = 1.0\n`));
}

find("record").addEventListener("change", () => addRecord(find("record").files[0]));
document.addEventListener("dragover", (event) => (event.preventDefault(), document.body.classList.add("over")));
document.addEventListener("dragleave", () => document.body.classList.remove("over"));
document.addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("over");
  addRecord(event.dataTransfer.files[0]);
});

// The history.

function showErrors(errors) {
  const items = errors.map(({ message, line, column }) => {
    const item = document.createElement("li");
    if (!line) item.textContent = message;
    else {
      const go = Object.assign(document.createElement("button"), { type: "button", textContent: `line ${line}, column ${column}: ${message}` });
      go.addEventListener("click", () => {
        const text = find("text");
        const at = text.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0) + column - 1;
        text.focus();
        text.setSelectionRange(at, at);
      });
      item.append(go);
    }
    return item;
  });
  find("errors").replaceChildren(...items);
  if (errors.length > 0) find("status").textContent = `The scenario has ${errors.length === 1 ? "an error" : `${errors.length} errors`}: see below the text. The picture is that of the last valid one.`;
}

const runFrames = createFrames(find("run"), "The structure in motion");
let askRun;
let changes = 0;

/** Changes the text of the scenario, and computes it. */
function edit(text) {
  if (find("text").value !== text) find("text").value = text;
  return computeRun();
}

const request = (more) => ({ scenario: find("text").value, files, ...more });

async function computeRun() {
  const change = ++changes;
  keepAddress();
  // The picture comes first, repetitions of rows of blocks after it.
  for (const no_repeat of [true, false]) {
    const answer = await askRun(request({ study: "run", no_repeat, names: ["report.html"] }));
    if (!answer || (!no_repeat && change !== changes)) return;
    if (answer.scenario) showScenario(answer.scenario);
    showErrors(answer.errors);
    if (answer.errors.length > 0) return;
    const [verdict] = answer.words.split("\n");
    find("answer").textContent = verdict;
    await runFrames.show(answer.files["report.html"]);
    page.answer = answer;
    const hasRow = last.scenario.free_hinges || last.scenario.elastic_joints;
    if (!hasRow || change !== changes) return;
  }
}

function keepAddress() {
  const text = find("text").value;
  history.replaceState(null, "", text === START ? location.pathname : `#${encodeURIComponent(text)}`);
}

/** Returns the scenario in the address; the first scenario if there is none. A damaged address says so. */
function textOfAddress() {
  if (location.hash.length < 2) return START;
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    find("broken").textContent = "The scenario in the address is damaged: this is the scenario that the page begins with.";
    find("broken").hidden = false;
    return START;
  }
}

let typed;
find("text").addEventListener("input", () => {
  clearTimeout(typed);
  typed = setTimeout(computeRun, 250);
});
addEventListener("hashchange", () => edit(textOfAddress()));

// Files.

function save(name, text) {
  const type = { csv: "text/csv", svg: "image/svg+xml", html: "text/html" }[name.split(".").at(-1)] ?? "text/plain";
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([text], { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

for (const button of document.querySelectorAll("[data-save]")) {
  button.addEventListener("click", async () => {
    const name = button.dataset.save;
    if (name.endsWith(".toml")) return save(name, find("text").value);
    const answer = await askStudy(request({ study: "run", names: [name] }));
    if (answer?.files[name]) save(name, answer.files[name]);
    else if (answer) showErrors(answer.errors);
  });
}

// Studies.

const STUDIES = [
  ["threshold", "Smallest factor that overturns", "Factors on the ground motion: which overturn the structure?"],
  ["map", "Map of pulses", "Which pulses overturn it: a coarse map first, then a finer one. [map] in the text sets the axes."],
  ["limit", "First motion (limit analysis)", "The acceleration that starts the motion, and the hinges."],
  ["capacity", "Capacity curve", "The static push that the moving structure can carry."],
  ["spread", "Movement of a springing", "How far may the right springing move outwards, inwards and down?"],
  ["verify", "Check by the Circolare 7/2019", "Needs the seismic demand in [demand]."],
  ["suite", "Suite of records", "Needs [suite] and its record files."],
  ["uncertain", "Histories of samples", "Needs [uncertain]; takes a minute or more."],
  ["uncertain_threshold", "Smallest factor of samples", "Needs [uncertain]; takes minutes."],
];
fill(find("study"), STUDIES);
const purpose = () => (find("purpose").textContent = STUDIES.find(([name]) => name === find("study").value)[2]);
find("study").addEventListener("change", purpose);
purpose();

const studyFrames = createFrames(find("study-page"), "The study");
let askStudy;
const DIRECTIONS = [0, 180, 90].map((angle_deg) => ({ springing: "right", angle_deg }));
/** Numbers of durations and of amplitudes of the maps, from coarse to fine; odd, so that the pulse of the history is the middle. */
const GRIDS = [[13, 11], [49, 41]];

/** Returns the texts of a map that gets finer, around the pulse of the scenario; a text with its own `[map]` is one map. */
function mapTexts() {
  const text = find("text").value;
  if (last.scenario.map) return [text];
  const motion = last.scenario.ground?.[last.ground];
  const around = (value, by) => `{ from = ${Number((value / by).toPrecision(3))}, to = ${Number((value * by).toPrecision(3))}`;
  return GRIDS.map(([columns, rows]) => {
    const more = `count = ${rows}, spacing = "logarithmic" }`;
    const axes = motion?.duration_s
      ? `duration_s = ${around(motion.duration_s, 4)}, count = ${columns}, spacing = "logarithmic" }\namplitude_g = ${around(Math.abs(motion.amplitude_g), 4)}, ${more}`
      : `scale = ${around(motion?.scale ?? 1, 4)}, ${more}`;
    return `${text.trimEnd()}\n\n[map]\n${axes}\n`;
  });
}

async function computeStudy(study) {
  const texts = study === "map" ? mapTexts() : [find("text").value];
  for (const scenario of texts) {
    const name = study === "map" ? "map.html" : null;
    const names = [name ?? `${study}.html`, "samples.html"];
    const answer = await askStudy({ scenario, files, study, names, options: study === "spread" ? { directions: DIRECTIONS } : {} });
    if (!answer) return;
    if (answer.errors.length > 0) {
      find("study-status").textContent = answer.errors.map(({ message }) => message).join("; ");
      return;
    }
    const html = Object.values(answer.files)[0];
    page.study = answer;
    await studyFrames.show(html);
    find("take").hidden = studyFrames.inside().document.getElementById("command") === null;
  }
}

find("compute").addEventListener("click", () => computeStudy(find("study").value));
find("take").addEventListener("click", () => {
  const command = studyFrames.inside()?.document.getElementById("command").textContent ?? "";
  const scenario = command.match(/<<'END'\n([\s\S]*?)END\n?$/)?.[1];
  if (!scenario) return;
  const values = command.split("\n")[0].matchAll(/--set ([\w.]+)=(\S+)/g);
  edit([...values].reduce((text, [, key, value]) => withValue(text, key, value), scenario));
  find("result").scrollIntoView({ behavior: "smooth" });
});

// The start.

/** For scripts: the last answers, and functions that change the scenario and compute. */
const page = { answer: null, study: null, edit, computeStudy, files, ask: (request) => askStudy(request) };
window.page = page;

try {
  const module = await compile();
  askRun = createQueue(module, find("status"), find("progress"), find("stop"));
  askStudy = createQueue(module, find("study-status"), find("study-progress"), find("study-stop"));
  await edit(textOfAddress());
} catch (error) {
  find("status").textContent = "";
  find("broken").hidden = false;
  find("broken").textContent =
    error instanceof WebAssembly.CompileError
      ? "This browser is too old for this page: it has no WebAssembly with SIMD. Update the browser, or install the program."
      : `The page cannot start: ${error.message}. From a folder on disk, open archrock.html, which needs no other file.`;
}
