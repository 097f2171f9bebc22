// The form: controls that change lines of the text, and follow it.

function fill(select, choices) {
  for (const [name, label] of choices) select.append(new Option(label, name));
}

/** Returns the value of a key in the scenario as JSON. */
const valueOf = (scenario, key) => key.split(".").reduce((table, name) => table?.[name], scenario);

/** Adds a word of help to controls, for the pointer and for screen readers. */
function help(words, ...controls) {
  for (const control of controls) Object.assign(control, { title: words, ariaDescription: words });
}

function createSlider([key, label, from, to, step, words]) {
  const row = document.createElement("div");
  row.className = "slider";
  const number = Object.assign(document.createElement("input"), { type: "number", step, id: `number-${key}` });
  const range = Object.assign(document.createElement("input"), { type: "range", min: from, max: to, step });
  const name = Object.assign(document.createElement("label"), { htmlFor: number.id, textContent: label });
  range.setAttribute("aria-label", label);
  const mark = Object.assign(document.createElement("output"), { className: "mark", hidden: true });
  row.append(name, number, range, mark);
  help(words, row, number, range);
  function change(value) {
    const text = find("text").value;
    if (value !== "" && hasTable(text, key.slice(0, key.lastIndexOf(".")))) edit(withValue(text, key, String(Number(value))), key);
  }
  range.addEventListener("input", () => change((number.value = range.value)));
  number.addEventListener("input", () => change(number.value));
  row.hidden = true;
  return {
    row,
    key,
    /** Marks a value beside the slider; null removes the mark. */
    mark(value) {
      mark.hidden = value === null || value < Number(range.min) || value > Number(range.max);
      if (mark.hidden) return;
      const place = (value - range.min) / (range.max - range.min);
      // The words stay beside the slider.
      mark.classList.toggle("end", place > 0.5);
      mark.textContent = place > 0.5 ? `${value} overturns ▲` : `▲ ${value} overturns`;
      row.style.setProperty("--place", place);
    },
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

help("Stones may slide on each other at joints that carry too little friction.", slips);
help("The shape of the structure. Its sliders change the numbers.", find("structure"));
help("The shape of the ground acceleration over time.", find("ground"));

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

/** Begins the name of a record among the pulses. */
const RECORD = "ground.record:";

/** Returns the name of the present ground motion: its table, and for a record its file. */
const groundName = () => (last.ground === "record" ? RECORD + last.scenario.ground.record.file : `ground.${last.ground}`);

/** The texts of tables that choices have removed, by the choice: they return with it. */
const left = {};

/** Replaces the tables of one choice by those of another one, to which it brings some keys that both have. */
function exchange(text, tables, [from, to], replacement, keys) {
  const { removed } = withoutTables(text, tables, "");
  if (removed.startsWith("[") && (!from || hasTable(removed, from.split(":")[0]))) left[from] = removed;
  const given = keys.filter((key) => parsed(text).some(({ path }) => path === `${from}.${key}`));
  const bring = (now, key) => withValue(now, `${to}.${key}`, JSON.stringify(valueOf(last.scenario, `${from}.${key}`)));
  return withTable(text, tables, to ? given.reduce(bring, left[to] ?? replacement) : (left[to] ?? replacement));
}

find("structure").addEventListener("change", () => {
  const name = find("structure").value;
  const isColumn = [name, last.kind].includes("column");
  const old = KINDS.concat(isColumn ? ["piers", "fill", "load", "vehicle", "tie"] : []);
  const [, , table] = STRUCTURES.find(([one]) => one === name);
  edit(exchange(find("text").value, old, [last.kind, name], table, isColumn ? [] : ["voussoirs", "depth_m", "density_kg_m3"]));
});
find("ground").addEventListener("change", () => {
  const text = find("text").value;
  const [from, to] = [groundName(), `ground.${find("ground").value}`];
  const all = groundTables(text);
  if (to.startsWith(RECORD)) return useRecord(to.slice(RECORD.length));
  // Tables of errors go as well.
  if (all.join() === from) return edit(withPulse(text, last.ground, find("ground").value));
  edit(exchange(text, all, [from, to], `[${to}]\namplitude_g = -0.35\nduration_s = 0.3\n`, ["start_s"]));
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
  choose(find("ground"), record ? `record:${record}` : last.ground, record ? `Record: ${record}` : last.ground, !scenario.ground || canChange(`ground.${last.ground}`));
  const model = (last.model = ["free_hinges", "elastic_joints"].find(has) ?? "");
  choose(find("model"), model, model, !model || canChange(model));
  const isBlock = kind === "column" && !model;
  find("about-model").textContent = isBlock ? "One rigid block, which rocks about its edges and loses energy when it hits its base." : MODELS.find(([one]) => one === model)[3];
  find("model").options[0].textContent = kind === "column" ? "One block" : MODELS[0][1];
  friction.hidden = !model;
  slips.checked = Boolean(model && scenario[model].friction_coefficient);
  for (const slider of sliders) slider.show(scenario);
  markThreshold();
}
