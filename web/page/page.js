// The page to try. The text of the scenario is its state: controls change it, and each change is computed in a worker.
const find = (id) => document.getElementById(id);
const MOST_BYTES = 16 << 20;
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

/** Makes a queue of one request at work and the newest one waiting, with elements that show long work. `read` receives the scenario of a run before its result. */
function createQueue(module, [status, bar, stop], read) {
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
      worker.onmessage = ({ data }) => {
        if (data.answer) finish(data.answer);
        else if (data.scenario) read?.(data.scenario);
        else show(data);
      };
      worker.onerror = (event) => halt({ errors: [{ message: `the worker failed: ${event.message}` }], files: {} });
      worker.postMessage(module);
    }
    worker.postMessage(work.request);
    work.timer = setTimeout(() => {
      stop.hidden = false;
      status.textContent = "Computing…";
      // While a history is repeated, its picture is the present one.
      if (work.request.no_repeat) markStale(true);
    }, 400);
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
            else if (isTrusted && target.id !== "time") choices[target.id] = target.value;
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
  const change = (value) => value !== "" && edit(withValue(find("text").value, key, String(Number(value))));
  range.addEventListener("input", () => change((number.value = range.value)));
  number.addEventListener("input", () => change(number.value));
  row.hidden = true;
  return {
    row,
    key,
    show(scenario) {
      const value = valueOf(scenario, key);
      // A key of an inline table can be changed in the text alone.
      row.hidden = typeof value !== "number" || !tableLines(find("text").value, key.slice(0, key.lastIndexOf(".")));
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
  const names = tableNames(find("text").value);
  const kind = kinds.find(has) ?? "";
  choose(find("structure"), kind, kind, names.includes(kind));
  const record = scenario.ground?.record?.file;
  choose(find("ground"), last.ground, record ? `Record: ${record}` : last.ground, !scenario.ground || names.includes(`ground.${last.ground}`));
  const model = ["free_hinges", "elastic_joints"].find(has) ?? "";
  choose(find("model"), model, model, !model || names.includes(model));
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
  const names = tableNames(text);
  const [first, ...others] = added;
  if (!first || others.length > 0 || names.includes("suite") || text.includes("slv_records")) return computeRun();
  const columns = /\.(csv|txt)$/i.test(first.name) ? 'unit = "g" # of the accelerations; see also the messages below\n' : "";
  return edit(withTable(text, names.filter((name) => name.startsWith("ground")), `[ground.record]\nfile = ${JSON.stringify(first.name)}\n${columns}scale = 1.0\n`));
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
  const missing = errors.some(({ message }) => message.includes("no such file was given"));
  const remedy = missing ? " (the address holds no records: choose the file again)" : "";
  find("status").textContent = `${errors[0].message}${remedy}${errors.length > 1 ? `; ${errors.length - 1} more below the text` : ""}`;
}

/** Marks the picture as that of an earlier scenario. */
function markStale(isStale) {
  find("run").classList.toggle("stale", isStale);
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
    find("study-status").textContent = studied && studied !== find("text").value ? "The study below is of an earlier scenario." : "";
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
// Back returns to the scenario before a change.
find("form").addEventListener("change", () => history.pushState(null, "", location.href));

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
let askFile;
/** The text of the study that is shown. */
let studied = null;
const DIRECTIONS = [0, 180, 90].map((angle_deg) => ({ springing: "right", angle_deg }));
/** Numbers of durations and of amplitudes of the maps, from coarse to fine; odd, so that the pulse of the history is the middle. */
const GRIDS = [[13, 11], [49, 41]];

/** The key that says how thick a structure is. */
const THICKNESSES = { arch: "thickness_ratio", pointed_arch: "thickness_m", elliptic_arch: "thickness_m", column: "width_m" };

/** Returns values around one, in the middle, up to a factor; ascending, and of its sign. */
function around(value, factor, count) {
  const part = (index) => factor ** ((2 * index) / (count - 1) - 1);
  const values = Array.from({ length: count }, (_, index) => Number((value * part(index)).toPrecision(6)));
  return `[${values.sort((a, b) => a - b).join(", ")}]`;
}

/** Returns the texts of a map that gets finer, around the pulse or the record of the scenario; a text with its own `[map]` is one map. */
function mapTexts() {
  const text = find("text").value;
  if (last.scenario.map) return [text];
  const motion = last.scenario.ground?.[last.ground];
  const structure = find("structure").value;
  const thickness = THICKNESSES[structure];
  return GRIDS.map(([columns, rows]) => {
    let axes = "";
    if (motion?.duration_s) axes = `duration_s = ${around(motion.duration_s, 4, columns)}\namplitude_g = ${around(motion.amplitude_g, 4, rows)}`;
    else if (motion && typeof last.scenario[structure]?.[thickness] === "number") {
      axes = `"${structure}.${thickness}" = ${around(last.scenario[structure][thickness], 1.25, columns)}\nscale = ${around(motion.scale ?? 1, 4, rows)}`;
    }
    return `${text.trimEnd()}\n\n[map]\n${axes}\n`;
  });
}

async function computeStudy(study) {
  const text = find("text").value;
  const texts = study === "map" ? mapTexts() : [text];
  for (const scenario of texts) {
    const names = [`${study}.html`, "samples.html"];
    const answer = await askStudy({ scenario, files, study, names, options: study === "spread" ? { directions: DIRECTIONS } : {} });
    if (!answer) return;
    if (answer.errors.length > 0) {
      find("study-status").textContent = answer.errors.map(({ message }) => message).join("\n");
      find("take").hidden = true;
      return studyFrames.clear();
    }
    const html = Object.values(answer.files)[0];
    page.study = answer;
    studied = text;
    await studyFrames.show(html);
    find("take").hidden = !studyFrames.inside().document.getElementById("command")?.textContent.startsWith("archrock run");
  }
}

find("compute").addEventListener("click", () => computeStudy(find("study").value));
find("take").addEventListener("click", () => {
  const command = studyFrames.inside()?.document.getElementById("command").textContent ?? "";
  const scenario = command.match(/<<'END'\n([\s\S]*?)END\n?$/)?.[1];
  if (!scenario) return;
  const values = [...command.split("\n")[0].matchAll(/--set ([\w."]+)=(\S+)/g)];
  // The cell of a map differs in some values, so the text keeps its comments.
  const text = values.length > 0 && studied === find("text").value ? studied : scenario;
  edit(values.reduce((now, [, key, value]) => withValue(now, key.replaceAll('"', ""), value), text));
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
  await edit(textOfAddress());
} catch (error) {
  find("status").textContent = "";
  find("broken").hidden = false;
  find("broken").textContent =
    error instanceof WebAssembly.CompileError
      ? "This browser is too old for this page: it has no WebAssembly with SIMD. Update the browser, or install the program."
      : `The page cannot start: ${error.message}. From a folder on disk, open archrock.html, which needs no other file.`;
}
