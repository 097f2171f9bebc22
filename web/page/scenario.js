// The text of a scenario: the library reads it, the sliders change lines of it.

const START = `# Rock an arch: change this text, or move the sliders.
[arch]
mean_radius_m = 5.0
thickness_ratio = 0.15
embrace_deg = 180.0
voussoirs = 36

[ground.half_sine]
amplitude_g = -0.3
duration_s = 0.3
`;

/** Kinds of structures, pulses and models: the name of the table, its label and its text. */
const STRUCTURES = [
  ["arch", "Circular arch", "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n"],
  ["pointed_arch", "Pointed arch", "[pointed_arch]\nspan_m = 8.0\nrise_m = 5.0\nthickness_m = 0.8\nvoussoirs = 36\n"],
  ["elliptic_arch", "Elliptic arch", "[elliptic_arch]\nspan_m = 8.0\nrise_m = 3.0\nthickness_m = 0.9\nvoussoirs = 36\n"],
  ["column", "Column", "[column]\nheight_m = 4.0\nwidth_m = 0.8\n"],
];
/** Pulses have the same keys, and wave trains these as well. A test compares the names with those of the program. */
const PULSES = [
  ["rectangular", "Rectangle"],
  ["step_pair", "Two steps"],
  ["half_sine", "Half sine"],
  ["one_sine", "One sine"],
  ["one_cosine", "One cosine"],
  ["triangular", "Triangle"],
  ["ricker", "Ricker"],
  ["antisymmetric_ricker", "Antisymmetric Ricker"],
  ["mavroeidis_papageorgiou", "Mavroeidis and Papageorgiou", ["gamma", "phase_deg"]],
  ["gabor", "Gabor", ["gamma", "phase_deg"]],
  ["windowed_sine", "Windowed sine", ["cycles", "phase_deg"]],
];
/** The sliders of the keys of wave trains: label, range. */
const WAVE_TRAIN = {
  gamma: ["Length in periods (gamma)", 1.1, 10, 0.1],
  cycles: ["Length in periods", 1, 10, 0.5],
  phase_deg: ["Phase (°)", -180, 180, 5],
};
/** Names of record files that are tables of numbers. */
const TABLE_FILE = /\.(csv|tsv|txt|dat)$/i;
/** Keys of such a record; the comments are for the reader to complete. */
const COLUMNS = `unit = "g" # of the accelerations; or "m/s2", "cm/s2"
# time_column = 1
# acceleration_column = 2
# dt_s = 0.01 # if there is no column of times
# skip_rows = 0
`;
/** All kinds of structures: the page offers the first ones. */
const KINDS = STRUCTURES.map(([name]) => name).concat("basket_arch", "blocks");
const MODELS = [
  ["", "Four links: hinges where they open first", ""],
  ["free_hinges", "Free hinges: any joint may open", "[free_hinges]\n"],
  ["elastic_joints", "Elastic joints", "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n"],
];

/** The sliders: key, label, range. A slider is shown if the scenario has its table. Ends that depend on other keys of the table leave most arches standing. */
const SLIDERS = {
  structure: [
    ["arch.mean_radius_m", "Mean radius (m)", 0.5, 20, 0.1],
    ["arch.span_m", "Span (m)", (arch) => 2 * (arch.rise_m ?? 0.5), 30, 0.1],
    ["arch.rise_m", "Rise (m)", (arch) => 0.2 * arch.span_m, (arch) => arch.span_m / 2, 0.1],
    ["arch.thickness_ratio", "Thickness / mean radius", 0.11, 0.4, 0.001],
    ["arch.thickness_m", "Thickness (m)", (arch) => 0.055 * (arch.span_m ?? 2 * arch.mean_radius_m), (arch) => 0.11 * (arch.span_m ?? 2 * arch.mean_radius_m), 0.01],
    ["arch.embrace_deg", "Embrace angle (°)", 100, 180, 1],
    ["arch.voussoirs", "Voussoirs", 5, 80, 1],
    ["pointed_arch.span_m", "Span (m)", (arch) => 6 * arch.thickness_m, (arch) => 2 * arch.rise_m, 0.1],
    ["pointed_arch.rise_m", "Rise (m)", (arch) => arch.span_m / 2, (arch) => 2 * arch.span_m, 0.1],
    ["elliptic_arch.span_m", "Span (m)", (arch) => 2 * arch.rise_m, (arch) => 4 * arch.rise_m, 0.1],
    ["elliptic_arch.rise_m", "Rise (m)", (arch) => 0.25 * arch.span_m, (arch) => 0.75 * arch.span_m, 0.1],
    ...["pointed_arch", "elliptic_arch"].flatMap((table) => [
      [`${table}.thickness_m`, "Thickness (m)", (arch) => 0.06 * arch.span_m, (arch) => 0.16 * arch.span_m, 0.01],
      [`${table}.voussoirs`, "Voussoirs", 5, 80, 1],
    ]),
    ["column.height_m", "Height (m)", 0.5, 20, 0.1],
    ["column.width_m", "Width (m)", 0.1, 4, 0.01],
  ],
  ground: [
    ...PULSES.flatMap(([pulse, , keys = []]) => [
      [`ground.${pulse}.amplitude_g`, "Amplitude (g): minus pushes right", -2, 2, 0.001],
      [`ground.${pulse}.duration_s`, "Duration (s)", 0.05, 3, 0.005],
      ...keys.map((key) => [`ground.${pulse}.${key}`, ...WAVE_TRAIN[key]]),
    ]),
    ["ground.record.scale", "Factor on the record", 0.05, 20, 0.01],
  ],
  model: [
    ["free_hinges.friction_coefficient", "Friction coefficient", 0.3, 1.5, 0.01],
    ["elastic_joints.normal_stiffness_gpa_m", "Normal stiffness (GPa/m)", 0.5, 200, 0.5],
    ["elastic_joints.friction_coefficient", "Friction coefficient", 0.3, 1.5, 0.01],
  ],
};

/** Returns the lines of a text, each with the path of its key or header, and the path of its table. An inline table is one line. */
function parsed(text) {
  let table = "";
  return text.replace(/\n*$/, "\n").split("\n").map((line) => {
    const header = line.match(/^\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(#.*)?$/)?.[1];
    table = header ?? table;
    const key = line.match(/^\s*([\w.-]+)\s*=/)?.[1];
    return { line, table, isHeader: header !== undefined, path: header ?? (key && (table ? `${table}.${key}` : key)) };
  });
}

/** Returns the text in which a table has another last name. */
function withName(text, table, name) {
  const rename = ({ line, path }) => (isWithin(path, table) ? line.replace(new RegExp(`\\b${table.split(".").at(-1)}\\b`), name) : line);
  return parsed(text).map(rename).join("\n");
}

/** Returns the text in which a pulse is of another kind. Keys that this does not have are removed. */
function withPulse(text, from, to) {
  const keysOf = (kind) => PULSES.find(([name]) => name === kind)?.[2] ?? [];
  const removed = keysOf(from).filter((key) => !keysOf(to).includes(key));
  const named = withName(text, `ground.${from}`, to);
  return removed.reduce((now, key) => withValue(now, `ground.${to}.${key}`, null), named);
}

const isWithin = (path, table) => path === table || path?.startsWith(`${table}.`);

/** Returns true if controls can change a table: the text has it as a table, with dotted keys or as an inline table. */
const hasTable = (text, table) => parsed(text).some(({ path }) => isWithin(path, table));

/** Returns the text in which a key, given with its table, has a value; without a value the key is removed. */
function withValue(text, key, value) {
  const dot = key.lastIndexOf(".");
  const [table, name] = [key.slice(0, dot), key.slice(dot + 1)];
  const all = parsed(text);
  const given = all.findIndex(({ path, isHeader }) => path === key && !isHeader);
  const inline = all.findIndex(({ path, isHeader }) => path === table && !isHeader);
  const from = all.findIndex(({ path, isHeader }) => path === table && isHeader);
  const dotted = all.findLastIndex(({ path, isHeader }) => isWithin(path, table) && !isHeader);
  const now = all.map(({ line }) => line);
  if (given >= 0 && value === null) now.splice(given, 1);
  else if (given >= 0) now[given] = now[given].replace(/=\s*[^#]*?(\s*#.*)?$/, `= ${value}$1`);
  else if (inline >= 0) {
    const entry = new RegExp(`([{,]\\s*)${name}\\s*=[^,}]*`);
    if (value === null) now[inline] = now[inline].replace(new RegExp(`,\\s*${name}\\s*=[^,}]*|${name}\\s*=[^,}]*,?`), "");
    else if (entry.test(now[inline])) now[inline] = now[inline].replace(entry, `$1${name} = ${value} `).replace(/ +,/, ",");
    else now[inline] = now[inline].replace(/,?\s*\}/, (end, at, line) => `${/\{\s*$/.test(line.slice(0, at)) ? " " : ", "}${name} = ${value} }`);
  } else if (value === null) return text;
  else if (from >= 0) {
    let to = from + 1;
    while (to < all.length && !all[to].isHeader) to += 1;
    now.splice(endOfTable(all, to), 0, `${name} = ${value}`);
  } else if (dotted >= 0) now.splice(dotted + 1, 0, now[dotted].replace(/[\w-]+\s*=.*/, `${name} = ${value}`));
  else now.push(`[${table}]`, `${name} = ${value}`, "");
  return now.join("\n");
}

/** Returns the end of a table before the line `to`: comments and empty lines before the next table belong to that. */
function endOfTable(all, to) {
  let end = to;
  while (end > 0 && /^\s*(#.*)?$/.test(all[end - 1].line)) end -= 1;
  return end;
}

/** Returns the text without some tables and the tables in them, and the lines that were removed. `place` takes the place of the first one. */
function withoutTables(text, tables, place) {
  const all = parsed(text);
  const isOld = (path) => tables.some((table) => isWithin(path, table));
  const kept = [];
  const removed = [];
  all.forEach(({ line, table, path, isHeader }, index) => {
    const next = all.findIndex((other, at) => at >= index && other.isHeader);
    const isEnd = !isHeader && index >= endOfTable(all, next < 0 ? all.length : next);
    if (isEnd || !(isOld(table) || isOld(path))) return kept.push(line);
    if (isHeader && !kept.includes(place)) kept.push(place);
    removed.push(line);
  });
  if (!kept.includes(place)) kept.push("", place);
  return { text: kept.join("\n"), removed: removed.join("\n") };
}

/** Returns the text in which the first of some tables is replaced by another text, and the others are removed. */
function withTable(text, tables, replacement) {
  const HERE = "\u0000";
  const now = withoutTables(text, tables, HERE).text;
  return now.replace(HERE, () => replacement.trimEnd()).replace(/\n{3,}/g, "\n\n").trimEnd() + "\n";
}

/** Returns the numbers of a scenario that another one has changed, as keys and values; null if they differ in more. Tables may be missing there. */
function changedNumbers(from, to, inside = "") {
  const changes = [];
  for (const [name, value] of Object.entries(to)) {
    const old = from[name];
    if (value === old) continue;
    if (typeof value === "number" && typeof old === "number") changes.push([inside + name, value]);
    else if (!value || !old || typeof value !== "object" || Array.isArray(value)) {
      if (JSON.stringify(value) !== JSON.stringify(old)) return null;
    } else {
      const deeper = changedNumbers(old, value, `${inside}${name}.`);
      if (!deeper) return null;
      changes.push(...deeper);
    }
  }
  return changes;
}
