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
const PULSES = [
  ["rectangular", "Rectangle"],
  ["half_sine", "Half sine"],
  ["one_sine", "One sine"],
  ["one_cosine", "One cosine"],
  ["step_pair", "Two steps"],
  ["triangular", "Triangle"],
  ["ricker", "Ricker"],
  ["antisymmetric_ricker", "Antisymmetric Ricker"],
];
const MODELS = [
  ["", "Four links: hinges where they open first", ""],
  ["free_hinges", "Free hinges: any joint may open", "[free_hinges]\n"],
  ["elastic_joints", "Elastic joints", "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n"],
];

/** The sliders: key, label, range. A slider is shown if the scenario has its table. */
const SLIDERS = {
  structure: [
    ["arch.mean_radius_m", "Mean radius (m)", 0.5, 20, 0.1],
    ["arch.span_m", "Span (m)", 1, 30, 0.1],
    ["arch.rise_m", "Rise (m)", 0.5, 25, 0.1],
    ["arch.thickness_ratio", "Thickness / mean radius", 0.11, 0.4, 0.001],
    ["arch.thickness_m", "Thickness (m)", 0.1, 4, 0.01],
    ["arch.embrace_deg", "Embrace angle (°)", 60, 180, 1],
    ["arch.voussoirs", "Voussoirs", 5, 80, 1],
    ...["pointed_arch", "elliptic_arch"].flatMap((table) => [
      [`${table}.span_m`, "Span (m)", 1, 30, 0.1],
      [`${table}.rise_m`, "Rise (m)", 0.5, 25, 0.1],
      [`${table}.thickness_m`, "Thickness (m)", 0.1, 4, 0.01],
      [`${table}.voussoirs`, "Voussoirs", 5, 80, 1],
    ]),
    ["column.height_m", "Height (m)", 0.5, 20, 0.1],
    ["column.width_m", "Width (m)", 0.1, 4, 0.01],
  ],
  ground: [
    ...PULSES.flatMap(([pulse]) => [
      [`ground.${pulse}.amplitude_g`, "Amplitude (g): minus pushes right", -2, 2, 0.001],
      [`ground.${pulse}.duration_s`, "Duration (s)", 0.05, 3, 0.005],
    ]),
    ["ground.record.scale", "Factor on the record", 0.05, 20, 0.01],
  ],
  model: [
    ["free_hinges.friction_coefficient", "Friction coefficient", 0.3, 1.5, 0.01],
    ["elastic_joints.normal_stiffness_gpa_m", "Normal stiffness (GPa/m)", 0.5, 200, 0.5],
    ["elastic_joints.friction_coefficient", "Friction coefficient", 0.3, 1.5, 0.01],
  ],
};

const lines = (text) => text.replace(/\n*$/, "\n").split("\n");
const header = (line) => line.match(/^\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(#.*)?$/)?.[1];

/** Returns the interval of lines of a table with its header; null if there is none. */
function tableLines(text, table) {
  const all = lines(text);
  const from = all.findIndex((line) => header(line) === table);
  if (from < 0) return null;
  let to = from + 1;
  while (to < all.length && header(all[to]) === undefined) to += 1;
  // Comments and empty lines before the next table belong to that.
  while (/^\s*(#.*)?$/.test(all[to - 1])) to -= 1;
  return { all, from, to };
}

/** Returns the text in which a key, given with its table, has a value; without a value the key is removed. */
function withValue(text, key, value) {
  const dot = key.lastIndexOf(".");
  const [table, name] = [key.slice(0, dot), key.slice(dot + 1)];
  const found = tableLines(text, table);
  if (!found) return value === null ? text : `${text.replace(/\n*$/, "\n")}\n[${table}]\n${name} = ${value}\n`;
  const { all, from, to } = found;
  const given = all.slice(from, to).findIndex((line) => line.match(/^\s*([\w-]+)\s*=/)?.[1] === name);
  if (given >= 0 && value === null) all.splice(from + given, 1);
  else if (given >= 0) all[from + given] = all[from + given].replace(/=\s*[^#]*?(\s*#.*)?$/, `= ${value}$1`);
  else if (value !== null) all.splice(to, 0, `${name} = ${value}`);
  return all.join("\n");
}

/** Returns the text in which the first of some tables is replaced by another one, and the others are removed. */
function withTable(text, tables, replacement) {
  const HERE = "\u0000";
  let now = text;
  for (const table of tables) {
    for (let found = tableLines(now, table); found; found = tableLines(now, table)) {
      const { all, from, to } = found;
      all.splice(from, to - from, ...(now.includes(HERE) ? [] : [HERE]));
      now = all.join("\n");
    }
  }
  if (!now.includes(HERE)) now = `${now.trimEnd()}\n\n${HERE}\n`;
  return now.replace(HERE, () => replacement.trimEnd()).replace(/\n{3,}/g, "\n\n").trimEnd() + "\n";
}

/** Returns the names of the tables in a text. */
const tableNames = (text) => lines(text).map(header).filter((name) => name !== undefined);
