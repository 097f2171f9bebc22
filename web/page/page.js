// The page to try. The text of the scenario is its state: controls change it, and each change is computed in a worker.
const find = (id) => document.getElementById(id);
const MOST_BYTES = 16 << 20;
/** Work that takes more seconds begins with its length. */
const LONG_S = 10;
/** Names and contents of the record files that the reader has added. */
const files = {};

// Workers.

/** Compiles the module, which is inside this page or beside it. */
async function compile() {
  const inside = find("module");
  return WebAssembly.compile(inside ? await unpack(inside.textContent) : await (await fetch("archrock.wasm")).arrayBuffer());
}

/** Unpacks the module in a worker, so that the page answers in between. */
function unpack(packed) {
  return new Promise((resolve, reject) => {
    const worker = new Worker(workerAddress);
    worker.onmessage = ({ data }) => {
      worker.terminate();
      if (data.error) reject(new Error(data.error));
      else resolve(data);
    };
    worker.postMessage(packed);
  });
}

const workerAddress = URL.createObjectURL(new Blob([find("worker").textContent], { type: "text/javascript" }));

/** Says how long work takes that has begun, and how long its rest. */
function estimate(began, done, all) {
  const passed_s = (performance.now() - began) / 1000;
  const all_s = (passed_s * all) / Math.max(done, 1);
  const words = (time_s) => (time_s < 90 ? `${Math.ceil(time_s)} s` : `${Math.ceil(time_s / 60)} min`);
  const whole = all_s > LONG_S ? `this takes some ${words(all_s)}; ` : "";
  return `Computing: ${whole}${Math.floor((100 * done) / all)} %, some ${words(all_s - passed_s)} left`;
}

/** Makes a queue of one request at work and the newest one waiting, with elements that show long work. `read` receives the scenario of a run before its result. */
function createQueue(module, [status, bar, stop], read) {
  /** Repetitions have a worker of their own: they may be stopped, and a new worker is slow at first. */
  const workers = new Map();
  const repeats = () => work.request.no_repeat === false;
  let work = null;
  let waiting = null;

  function createWorker() {
    const worker = new Worker(workerAddress);
    worker.onmessage = ({ data }) => {
      if (data.answer) finish(data.answer);
      else if (data.scenario) read?.(data.scenario);
      else show(data);
    };
    worker.onerror = (event) => halt({ errors: [{ message: `the worker failed: ${event.message}` }], files: {} });
    worker.postMessage(module);
    return worker;
  }

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
    if (!workers.has(repeats())) workers.set(repeats(), createWorker());
    workers.get(repeats()).postMessage(work.request);
    work.timer = setTimeout(() => {
      stop.hidden = false;
      status.textContent = "Computing…";
      // While a history is repeated, its picture is the present one.
      if (work.request.no_repeat) markStale(true);
    }, 400);
  }

  function show({ done, all }) {
    if (!work) return;
    // Some studies have several rounds.
    if (!(done >= work.done)) work.round = performance.now();
    work.done = done;
    if (stop.hidden) return;
    bar.hidden = false;
    bar.value = all > 0 ? done / all : 0;
    const end = work.request.study === "run" ? "Repeating with other steps…" : "Drawing…";
    status.textContent = done >= all ? end : estimate(work.round, done, all);
  }

  /** Ends the work with this answer; `null` means that nobody waits for it. */
  function halt(answer) {
    if (!work) return;
    workers.get(repeats()).terminate();
    workers.delete(repeats());
    finish(answer);
  }

  stop.addEventListener("click", () => {
    halt(null);
    status.textContent = read ? "Stopped. Any change computes again." : "Stopped.";
  });

  /** Returns the answer to a request; null if a newer one has replaced it or it was stopped. */
  return function ask(request) {
    return new Promise((resolve) => {
      waiting?.resolve(null);
      waiting = { request, resolve };
      if (!work) begin(waiting);
      // A reader who goes on waits neither for repetitions nor for long work.
      else if (repeats() || performance.now() - work.began > 1000) halt(null);
    });
  };
}

// Pages of results, each in a frame.

/** Shows pages in a holder. A page like the last one, as of the next history, is shown in its frame. */
function createFrames(holder, title) {
  let frame = null;
  let observer = null;
  /** The fields that the reader has changed, with their values. */
  const choices = {};

  /** Replaces the words, the picture and the plots in the frame by those of a page of another history. */
  async function renew(html) {
    const inside = frame.contentWindow;
    const next = new DOMParser().parseFromString(html, "text/html");
    // The page answers its reader in between.
    await new Promise((resolve) => setTimeout(resolve));
    for (const part of ["header", "section:last-of-type"]) inside.document.querySelector(part).replaceWith(next.querySelector(part));
    const complete = inside.archrock.renew(JSON.parse(next.getElementById("data").textContent));
    for (const [id, value] of Object.entries(choices)) {
      const field = inside.document.getElementById(id);
      if (field.type === "checkbox") {
        if (field.checked !== value) field.click();
        continue;
      }
      field.value = value;
      field.dispatchEvent(new Event("input"));
    }
    await complete;
  }

  return {
    inside: () => frame?.contentWindow,
    clear() {
      observer?.disconnect();
      frame?.remove();
      frame = null;
    },
    show(html) {
      if (frame?.contentWindow.archrock?.renew) return renew(html);
      const next = document.createElement("iframe");
      Object.assign(next, { className: "waiting", title, scrolling: "no", srcdoc: html });
      holder.querySelectorAll(".waiting").forEach((other) => other.remove());
      holder.append(next);
      return new Promise((resolve) => {
        next.onload = async () => {
          const root = next.contentDocument.documentElement;
          const fit = () => (next.style.height = `${Math.ceil(root.getBoundingClientRect().height) + 2}px`);
          root.style.overflow = "hidden";
          root.addEventListener("change", ({ target, isTrusted }) => {
            if (target.type === "checkbox") choices[target.id] = target.checked;
            // Each history opens with the worse direction.
            else if (isTrusted && !["time", "direction"].includes(target.id)) choices[target.id] = target.value;
          });
          takeDrops(next.contentDocument);
          next.classList.remove("waiting");
          observer?.disconnect();
          frame?.remove();
          frame = next;
          observer = new ResizeObserver(fit);
          observer.observe(root);
          await next.contentWindow.archrock?.ready;
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
  function change(value) {
    const text = find("text").value;
    if (value !== "" && hasTable(text, key.slice(0, key.lastIndexOf(".")))) edit(withValue(text, key, String(Number(value))));
  }
  range.addEventListener("input", () => change((number.value = range.value)));
  number.addEventListener("input", () => change(number.value));
  row.hidden = true;
  return {
    row,
    key,
    show(scenario) {
      const value = valueOf(scenario, key);
      // Keys of tables inside inline tables can be changed in the text alone.
      const table = key.slice(0, key.lastIndexOf("."));
      row.hidden = typeof value !== "number" || !hasTable(find("text").value, table);
      if (row.hidden || row.contains(document.activeElement)) return;
      // A value beyond the range widens it.
      const inSteps = (place) => Number((step * Math.round(place / step)).toFixed(3));
      const [low, high] = [from, to].map((end) => (typeof end === "function" ? inSteps(end(valueOf(scenario, table))) : end));
      range.min = Math.min(low, value);
      range.max = Math.max(high, value);
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

find("form").addEventListener("focusout", () => setTimeout(() => sliders.forEach((slider) => slider.show(last.scenario))));

const friction = Object.assign(document.createElement("label"), { className: "switch", textContent: " joints may slip", hidden: true });
const slips = Object.assign(document.createElement("input"), { type: "checkbox" });
friction.prepend(slips);
document.querySelector('[data-part="model"]').append(friction);
slips.addEventListener("change", () => edit(withValue(find("text").value, `${find("model").value}.friction_coefficient`, slips.checked ? 0.8 : null)));

fill(find("structure"), STRUCTURES);
fill(find("ground"), PULSES);
fill(find("model"), MODELS);

/** Shows a choice, also one that the page does not offer. Tables that the text has in another form cannot be changed here. */
function choose(select, name, label, canChange) {
  select.querySelector(".other")?.remove();
  const known = [...select.options].some((option) => option.value === name);
  if (!known) select.append(Object.assign(new Option(label || "none", name), { className: "other" }));
  select.value = name;
  select.disabled = !canChange;
}

/** The texts of tables that choices have removed, by the choice: they return with it. */
const left = {};

/** Replaces the tables of one choice by those of another one, to which it brings some keys that both have. */
function exchange(text, tables, [from, to], replacement, keys) {
  const { removed } = withoutTables(text, tables, "");
  if (removed.startsWith("[")) left[from] = removed;
  const given = keys.filter((key) => parsed(text).some(({ path }) => path === `${from}.${key}`));
  const bring = (now, key) => withValue(now, `${to}.${key}`, JSON.stringify(valueOf(last.scenario, `${from}.${key}`)));
  return withTable(text, tables, to ? given.reduce(bring, left[to] ?? replacement) : (left[to] ?? replacement));
}

find("structure").addEventListener("change", () => {
  const name = find("structure").value;
  const isColumn = [name, last.kind].includes("column");
  const old = KINDS.concat(isColumn ? ["piers", "fill", "load", "tie"] : []);
  const [, , table] = STRUCTURES.find(([one]) => one === name);
  edit(exchange(find("text").value, old, [last.kind, name], table, isColumn ? [] : ["voussoirs", "depth_m", "density_kg_m3"]));
});
find("ground").addEventListener("change", () => {
  const text = find("text").value;
  const kinds = [last.ground, find("ground").value];
  const [from, to] = kinds.map((name) => `ground.${name}`);
  if (last.ground !== "record" && hasTable(text, from)) return edit(withPulse(text, ...kinds));
  edit(exchange(text, [from], [from, to], `[${to}]\namplitude_g = -0.3\nduration_s = 0.3\n`, ["start_s"]));
});
find("model").addEventListener("change", () => {
  const [name, , table] = MODELS.find(([one]) => one === find("model").value);
  const text = find("text").value;
  const needsBlocks = table && hasTable(text, "arch") && !last.scenario.arch?.voussoirs;
  const cut = needsBlocks ? withValue(text, "arch.voussoirs", 36) : text;
  edit(exchange(cut, ["free_hinges", "elastic_joints", "impact"], [last.model, name], table, ["friction_coefficient", "longest_step_s"]));
});

/** The last valid scenario, and the names of its structure, ground motion and model. */
const last = { scenario: {}, kind: "", ground: "", model: "" };

function showScenario(scenario) {
  last.scenario = scenario;
  last.ground = Object.keys(scenario.ground ?? {}).find((name) => name !== "right") ?? "";
  const has = (name) => scenario[name] !== undefined;
  const canChange = (name) => hasTable(find("text").value, name);
  const kind = (last.kind = KINDS.find(has) ?? "");
  choose(find("structure"), kind, kind, canChange(kind));
  const record = scenario.ground?.record?.file;
  choose(find("ground"), last.ground, record ? `Record: ${record}` : last.ground, !scenario.ground || canChange(`ground.${last.ground}`));
  const model = (last.model = ["free_hinges", "elastic_joints"].find(has) ?? "");
  choose(find("model"), model, model, !model || canChange(model));
  find("model").options[0].textContent = kind === "column" ? "One block" : MODELS[0][1];
  friction.hidden = !model;
  slips.checked = Boolean(model && scenario[model].friction_coefficient);
  for (const slider of sliders) slider.show(scenario);
}

// Records.

/** Adds files. A single one becomes the ground motion, unless the scenario names files already. */
async function addRecords(added) {
  for (const file of added) {
    if (file.size > MOST_BYTES) {
      const size = (file.size / 1048576).toFixed(0);
      return showErrors([{ message: `${file.name} has ${size} MB; this page takes records of at most 16 MB: use the program, or cut the file` }]);
    }
    const contents = await file.text();
    if (contents.includes("\u0000")) return showErrors([{ message: `${file.name} is not a text, so no record that this page reads` }]);
    // Scenarios of the repository name a folder.
    files[file.name] = files[`records/${file.name}`] = contents;
  }
  const text = find("text").value;
  const [first, ...others] = added;
  if (!first || others.length > 0 || hasTable(text, "suite") || text.includes("slv_records")) return computeRun();
  const columns = TABLE_FILE.test(first.name) ? COLUMNS : "";
  return edit(withTable(text, ["ground"], `[ground.record]\nfile = ${JSON.stringify(first.name)}\n${columns}scale = 1.0\n`));
}

find("record").addEventListener("change", () => addRecords(find("record").files));

/** Takes files that are dropped on a document. */
function takeDrops(on) {
  const withFiles = (act) => (event) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    act(event);
  };
  on.addEventListener("dragover", withFiles(() => document.body.classList.add("over")));
  on.addEventListener("dragleave", () => document.body.classList.remove("over"));
  on.addEventListener("drop", withFiles((event) => {
    document.body.classList.remove("over");
    addRecords(event.dataTransfer.files);
  }));
}
takeDrops(document);

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
  markStale(errors.length > 0);
  if (errors.length === 0) return;
  const more = errors.length > 1 ? `; ${errors.length - 1} more below the text` : "";
  // A slider may have gone beyond the structures that stand.
  const remedy = document.activeElement.closest(".slider") ? " (move the slider back, or change another one)" : "";
  find("status").textContent = `${errors[0].message}${more}${remedy}`;
}

/** Marks the picture as that of an earlier scenario. */
function markStale(isStale) {
  find("run").classList.toggle("stale", isStale);
}

/** Marks a study of an earlier scenario. */
function markStudy() {
  const isEarlier = studied !== null && studied !== find("text").value;
  find("earlier").hidden = !isEarlier;
  find("study-page").classList.toggle("stale", isEarlier);
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
  markStudy();
  // What was wrong with an earlier text.
  for (const part of ["study-", "save-"]) if (find(`${part}stop`).hidden) find(`${part}status`).textContent = "";
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
    if (!hasRow || !no_repeat) return;
    // Browsers let a stopped worker compute for some seconds: repetitions begin once the reader pauses.
    await new Promise((resolve) => setTimeout(resolve, 1000));
    if (change !== changes) return;
  }
}

let kept;
/** Keeps the text in the address, a moment later: browsers refuse many changes in a row. */
function keepAddress() {
  clearTimeout(kept);
  kept = setTimeout(() => {
    const text = find("text").value;
    history.replaceState(null, "", text === START ? location.pathname : `#${encodeURIComponent(text)}`);
  }, 200);
}
/** Lets Back return to the present scenario after a change. */
const remember = () => history.pushState(null, "", location.href);
find("form").addEventListener("change", remember);

/** Returns the scenario in the address, the first scenario if there is none, or the present one if the address is damaged. */
function textOfAddress() {
  find("broken").hidden = true;
  if (location.hash.length < 2) return START;
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    find("broken").textContent = "The scenario in the address is damaged: the text below is not that of the link.";
    find("broken").hidden = false;
    return find("text").value || START;
  }
}

let typed;
find("text").addEventListener("input", () => {
  clearTimeout(typed);
  typed = setTimeout(computeRun, 250);
});
addEventListener("popstate", () => edit(textOfAddress()));

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
    const answer = await askFile(request({ study: "run", names: [name] }));
    if (answer?.files[name]) save(name, answer.files[name]);
    else if (answer) find("save-status").textContent = `Nothing is saved: ${answer.errors[0].message}`;
  });
}

// Studies.

const STUDIES = [
  ["threshold", "Smallest factor that overturns", "Factors on the ground motion: which overturn the structure?"],
  ["map", "Map of pulses", "Which pulses overturn it: a coarse map first, then finer ones. [map] in the text sets the axes."],
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
let askFile;
/** The text of the study that is shown. */
let studied = null;
const DIRECTIONS = [0, 180, 90].map((angle_deg) => ({ springing: "right", angle_deg }));
/** Numbers of durations and of amplitudes of the maps, from coarse to fine: each has all cells of the one before, and the pulse of the history in the middle. */
const GRIDS = [[7, 5], [13, 9], [25, 17], [49, 33]];

/** On this page a button takes the place of the command of a case. */
const NO_COMMAND = "<style>p:has(+ #command), #command, #command + p { display: none; }</style>";

/** Keys that give the thickness of a structure; a scenario has one of them. */
const THICKNESSES = ["thickness_ratio", "thickness_m", "width_m"];

/** Returns values around one, in the middle, up to a factor; ascending, and of its sign. */
function around(value, factor, count) {
  const part = (index) => factor ** ((2 * index) / (count - 1) - 1);
  const values = Array.from({ length: count }, (_, index) => Number((value * part(index)).toPrecision(6)));
  return `[${values.sort((a, b) => a - b).join(", ")}]`;
}

/** Returns the texts of a map that gets finer, around the pulse or the record of the scenario, or with the axes of its own `[map]`. */
function mapTexts() {
  const text = find("text").value;
  const own = Object.entries(last.scenario.map ?? {});
  if (own.length > 0) {
    const range = ({ from, to, spacing }, count) => `{ from = ${from}, to = ${to}, count = ${count}, spacing = "${spacing}" }`;
    const coarser = (count) => (now, [key, axis]) => (axis.count > count && !key.includes(".") ? withValue(now, `map.${key}`, range(axis, count)) : now);
    return [...new Set([...GRIDS.map(([columns]) => own.reduce(coarser(columns), text)), text])];
  }
  const motion = last.scenario.ground?.[last.ground];
  const structure = find("structure").value;
  const thickness = THICKNESSES.find((key) => typeof last.scenario[structure]?.[key] === "number");
  return GRIDS.map(([columns, rows]) => {
    let axes = "";
    if (motion?.duration_s) axes = `duration_s = ${around(motion.duration_s, 4, columns)}\namplitude_g = ${around(motion.amplitude_g, 4, rows)}`;
    else if (motion && thickness) {
      axes = `"${structure}.${thickness}" = ${around(last.scenario[structure][thickness], 1.25, columns)}\nscale = ${around(motion.scale ?? 1, 4, rows)}`;
    }
    return `${text.trimEnd()}\n\n[map]\n${axes}\n`;
  });
}

/** Queues of workers that compute cells of maps beside each other; they show nothing. */
const helpers = [];

function startHelpers(module) {
  const count = Math.min(navigator.hardwareConcurrency || 1, 4);
  for (let i = 0; i < count; i += 1) {
    const hidden = ["span", "progress", "button"].map((name) => document.createElement(name));
    helpers.push({ ask: createQueue(module, hidden), stop: () => hidden[2].click() });
  }
  find("study-stop").addEventListener("click", stopHelpers);
}

const stopHelpers = () => helpers.forEach(({ stop }) => stop());

/** Computes a map and yields the answer of each level, from coarse to fine. Cells are computed once. */
async function* mapAnswers(texts) {
  const [status, bar, stop] = ["status", "progress", "stop"].map((name) => find(`study-${name}`));
  const grids = [];
  for (const scenario of texts) {
    const answer = await askStudy({ scenario, files, study: "map", cells: [] });
    if (!answer?.axes) return yield answer;
    const [xs, ys] = answer.axes;
    grids.push({ scenario, size: `${xs.length} × ${ys.length}`, keys: xs.flatMap((x) => ys.map((y) => `${x} ${y}`)) });
  }
  const began = performance.now();
  const all = new Set(grids.flatMap(({ keys }) => keys)).size;
  const rows = new Map();
  // Number of cells of one request.
  let together = 8;
  let shown = "";
  const show = () => {
    if (performance.now() - began < 400) return;
    stop.hidden = bar.hidden = false;
    bar.value = rows.size / all;
    status.textContent = shown + estimate(began, rows.size, all);
  };
  for (const { scenario, size, keys } of grids) {
    const todo = [...keys.keys()].filter((cell) => !rows.has(keys[cell]));
    let failed = false;
    const help = async ({ ask }) => {
      while (todo.length > 0 && failed === false) {
        const cells = todo.splice(0, Math.min(together, Math.ceil(todo.length / helpers.length)));
        const asked = performance.now();
        const answer = await ask({ scenario, files, study: "map", cells });
        if (performance.now() - asked < 200) together *= 2;
        if (!answer?.axes) return (failed = answer);
        cells.forEach((cell, index) => rows.set(keys[cell], answer.rows[index]));
        show();
      }
    };
    await Promise.all(helpers.map(help));
    if (failed !== false) {
      stop.hidden = bar.hidden = true;
      if (status.textContent === "Stopped.") status.textContent = `${shown}Stopped.`;
      return yield failed;
    }
    // Levels that follow at once are not worth a picture.
    if (scenario !== texts.at(-1) && shown && performance.now() - began < 400) continue;
    shown = `The map shows ${size} of ${grids.at(-1).size} cells. `;
    yield askStudy({ scenario, files, study: "map", names: ["map.html"], rows: keys.map((key) => rows.get(key)) });
    show();
  }
  stop.hidden = bar.hidden = true;
  status.textContent = "";
}

async function* studyAnswers(study, scenario) {
  if (study === "map") return yield* mapAnswers(mapTexts());
  const names = [`${study}.html`, "samples.html"];
  yield askStudy({ scenario, files, study, names, options: study === "spread" ? { directions: DIRECTIONS } : {} });
}

let studies = 0;
async function computeStudy(study) {
  const own = ++studies;
  stopHelpers();
  find("study-status").textContent = "";
  const text = find("text").value;
  for await (const answer of studyAnswers(study, text)) {
    if (!answer || own !== studies) return;
    showStudyErrors(study, answer.errors);
    if (answer.errors.length > 0) {
      studied = null;
      markStudy();
      return studyFrames.clear();
    }
    page.study = answer;
    studied = text;
    markStudy();
    const mark = studyFrames.inside()?.archrock;
    const kept = mark?.stays?.() && mark.data.axes.map(({ values }, i) => values[mark.chosen()[i]]);
    await studyFrames.show(Object.values(answer.files)[0].replace("</head>", `${NO_COMMAND}</head>`));
    const { archrock, document: shown } = studyFrames.inside();
    // A cell that the reader has marked stays so on a finer map.
    const places = kept && archrock.data.axes?.map(({ values }, i) => values.indexOf(kept[i]));
    if (places && !places.includes(-1)) archrock.keep(places);
    find("take").hidden = !shown.getElementById("command")?.textContent.startsWith("archrock run");
    if (own !== studies) return;
  }
}

/** Shows why there is no study. A table that the scenario lacks can be added as the message gives it. */
function showStudyErrors(study, errors) {
  if (errors.length > 0) {
    find("study-status").textContent = errors.map(({ message }) => message).join("\n");
    find("take").hidden = true;
  }
  const [, table] = errors[0]?.message.match(/such as\n\n(\[[^]*)/) ?? [];
  find("add").hidden = !table;
  find("add").onclick = () => {
    find("add").hidden = true;
    remember();
    // A suite names the files that are here.
    const here = Object.keys(files).filter((name) => !name.includes("/"));
    const columns = here.some((name) => TABLE_FILE.test(name)) ? COLUMNS : "";
    const ready = here.length > 0 ? table.replace('"records/*.at2"', `${JSON.stringify(here)}\n${columns.trimEnd()}`) : table;
    edit(`${find("text").value.trimEnd()}\n\n${ready.trimEnd()}\n`);
    computeStudy(study);
  };
}

find("compute").addEventListener("click", () => computeStudy(find("study").value));
find("take").addEventListener("click", async () => {
  const command = studyFrames.inside()?.document.getElementById("command").textContent ?? "";
  const scenario = command.match(/<<'END'\n([\s\S]*?)END\n?$/)?.[1];
  if (!scenario) return;
  const set = [...command.split("\n")[0].matchAll(/--set ([\w."]+)=(\S+)/g)];
  const changed = set.length > 0 ? null : await askFile({ scenario, files });
  const numbers = set.length > 0 ? set.map(([, key, value]) => [key.replaceAll('"', ""), value]) : changed?.scenario && changedNumbers(page.study.scenario, changed.scenario);
  // A case that differs in some numbers leaves the comments of the text.
  const isOwn = numbers && studied === find("text").value;
  const text = (numbers ?? []).reduce((now, [key, value]) => withValue(now, key, value), isOwn ? studied : scenario);
  // A map has the pulses of all its cells.
  if (isOwn && set.length > 0) studied = text;
  remember();
  edit(text);
  find("result").scrollIntoView({ behavior: "smooth" });
});

// The start.

/** For scripts: the last answers, and functions that change the scenario and compute. */
const page = { answer: null, study: null, edit, computeStudy, files, ask: (request) => askStudy(request) };
window.page = page;

try {
  const module = await compile();
  const work = (part) => ["status", "progress", "stop"].map((name) => find(`${part}${name}`));
  askRun = createQueue(module, work(""), showScenario);
  askStudy = createQueue(module, work("study-"));
  askFile = createQueue(module, work("save-"));
  startHelpers(module);
  await edit(textOfAddress());
} catch (error) {
  find("status").textContent = "";
  find("broken").hidden = false;
  find("broken").textContent =
    error instanceof WebAssembly.CompileError
      ? "This browser is too old for this page: it has no WebAssembly with SIMD. Update the browser, or install the program."
      : `The page cannot start: ${error.message}. From a folder on disk, open archrock.html, which needs no other file.`;
}
