// Studies of the scenario, each on a page in a frame.

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

/** The names of all files of a study. */
const ALL = ["*"];

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

/** Elements of a queue that shows nothing. */
const helperElements = () => ["span", "progress", "button"].map((name) => document.createElement(name));

function startHelpers(module) {
  const count = Math.min(navigator.hardwareConcurrency || 1, 4);
  for (let i = 0; i < count; i += 1) {
    const hidden = helperElements();
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
    yield askStudy({ scenario, files, study: "map", names: ALL, rows: keys.map((key) => rows.get(key)) });
    show();
  }
  stop.hidden = bar.hidden = true;
  status.textContent = "";
}

async function* studyAnswers(study, scenario) {
  if (study === "map") return yield* mapAnswers(mapTexts());
  yield askStudy({ scenario, files, study, names: ALL, options: study === "spread" ? { directions: DIRECTIONS } : {} });
}

let studies = 0;
async function computeStudy(study) {
  const own = ++studies;
  stopHelpers();
  find("study-status").textContent = "";
  const text = find("text").value;
  showSaves({});
  // The text may be new: a map needs its scenario.
  const read = await askFile({ scenario: text, files });
  if (own !== studies) return;
  if (read?.scenario) showScenario(read.scenario);
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
    showSaves(answer.files);
    if (study === "threshold") found = { text, factor: answer.summary.models[0].lowest_factor, scenario: answer.scenario };
    markThreshold();
    const html = answer.files[`${study}.html`] ?? answer.files["samples.html"];
    try {
      await studyFrames.show(html.replace("</head>", `${NO_COMMAND}</head>`));
    } catch (error) {
      find("study-status").textContent = error.message;
      return;
    }
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
    // A suite names the files that are here.
    const here = recordNames();
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
  edit(text);
  scrollTo({ top: 0, behavior: "smooth" });
});

/** Offers the files of a study. */
function showSaves(made) {
  const buttons = Object.entries(made).map(([name, text]) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
    button.addEventListener("click", () => save(name, text));
    return button;
  });
  find("study-files").replaceChildren(...(buttons.length > 0 ? ["Save ", ...buttons] : []));
}

/** Returns a scenario without the amplitude of its pulse. */
const withoutAmplitude = (text) => withValue(text, `ground.${last.ground}.amplitude_g`, null);

/** The last threshold: its text, its scenario, and the smallest factor that overturns. */
let found = null;

/** Marks the smallest amplitude that overturns the structure beside its slider, once a threshold has found it. */
function markThreshold() {
  const key = `ground.${last.ground}.amplitude_g`;
  const isOf = found?.factor && withoutAmplitude(found.text) === withoutAmplitude(find("text").value);
  const value = isOf ? Number((found.factor * valueOf(found.scenario, key)).toPrecision(3)) : null;
  for (const slider of sliders) if (slider.key.endsWith(".amplitude_g")) slider.mark(slider.key === key ? value : null);
}
