// What the page offers: kinds of structures, pulses and models, sliders with a word of help, questions and studies.

const START = `# Rock an arch: change this text, or move the sliders.
[arch]
mean_radius_m = 5.0
thickness_ratio = 0.15
embrace_deg = 180.0
voussoirs = 36

[free_hinges]

[ground.half_sine]
amplitude_g = -0.35
duration_s = 0.3
`;

/** Kinds of structures, pulses and models: the name of the table, its label and its text. With each pulse the structures move visibly. */
const STRUCTURES = [
  ["arch", "Circular arch", "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 36\n"],
  ["pointed_arch", "Pointed arch", "[pointed_arch]\nspan_m = 10.0\nrise_m = 6.0\nthickness_m = 0.65\nvoussoirs = 36\n"],
  ["elliptic_arch", "Elliptic arch", "[elliptic_arch]\nspan_m = 8.0\nrise_m = 3.0\nthickness_m = 0.58\nvoussoirs = 36\n"],
  ["column", "Column", "[column]\nheight_m = 4.0\nwidth_m = 0.6\n"],
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
/** The sliders of the keys of wave trains: label, range, help. */
const WAVE_TRAIN = {
  gamma: ["Length in periods (gamma)", 1.1, 10, 0.1, "How many periods the wave train has: more give more swings."],
  cycles: ["Length in periods", 1, 10, 0.5, "How many periods the wave train has: more give more swings."],
  phase_deg: ["Phase (°)", -180, 180, 5, "Where in its period the wave is when its envelope is largest."],
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
const KINDS = STRUCTURES.map(([name]) => name).concat("basket_arch", "blocks", "body");
const MODELS = [
  ["", "Four links: hinges where they open first", "", "The fastest model: four hinges that stay where they opened first. A rough guide for arches."],
  ["free_hinges", "Free hinges: any joint may open", "[free_hinges]\n", "Rigid blocks whose joints open and close anywhere. It makes the fewest assumptions: quote this one."],
  ["elastic_joints", "Elastic joints", "[elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n", "Blocks on elastic joints, as of mortar or soft stone. Slower to compute."],
];

const SPAN = "Distance between the springings, where the arch begins.";
const RISE = "Height of the crown above the springings.";
const THICKNESS = "Thicker arches resist more: they move at a stronger push.";
const VOUSSOIRS = "Number of stones. Hinges open at the joints between them.";
const FRICTION = "Stone on stone has 0.5 to 0.8: with less, joints slip.";

/** The sliders: key, label, range, help. A slider is shown if the scenario has its table. Ends that depend on other keys of the table leave most arches standing. */
const SLIDERS = {
  structure: [
    ["arch.mean_radius_m", "Mean radius (m)", 0.5, 20, 0.1, "Half the span of a semicircle, at half the thickness. Of two equal shapes the larger one is harder to overturn."],
    ["arch.span_m", "Span (m)", (arch) => 2 * (arch.rise_m ?? 0.5), 30, 0.1, SPAN],
    ["arch.rise_m", "Rise (m)", (arch) => 0.2 * arch.span_m, (arch) => arch.span_m / 2, 0.1, RISE],
    ["arch.thickness_ratio", "Thickness / mean radius", 0.11, 0.4, 0.001, `${THICKNESS} A semicircle below 0.107 falls under its own weight.`],
    ["arch.thickness_m", "Thickness (m)", (arch) => 0.055 * (arch.span_m ?? 2 * arch.mean_radius_m), (arch) => 0.11 * (arch.span_m ?? 2 * arch.mean_radius_m), 0.01, THICKNESS],
    ["arch.embrace_deg", "Embrace angle (°)", 100, 180, 1, "Angle of the arch from springing to springing: 180 is a semicircle."],
    ["arch.voussoirs", "Voussoirs", 5, 80, 1, VOUSSOIRS],
    ["pointed_arch.span_m", "Span (m)", (arch) => 6 * arch.thickness_m, (arch) => 2 * arch.rise_m, 0.1, SPAN],
    ["pointed_arch.rise_m", "Rise (m)", (arch) => arch.span_m / 2, (arch) => Math.min(2 * arch.span_m, 20 * arch.thickness_m), 0.1, RISE],
    ["elliptic_arch.span_m", "Span (m)", (arch) => 2 * arch.rise_m, (arch) => Math.min(4 * arch.rise_m, 18 * arch.thickness_m), 0.1, SPAN],
    ["elliptic_arch.rise_m", "Rise (m)", (arch) => 0.25 * arch.span_m, (arch) => 0.75 * arch.span_m, 0.1, RISE],
    ...["pointed_arch", "elliptic_arch"].flatMap((table) => [
      [`${table}.thickness_m`, "Thickness (m)", (arch) => 0.06 * arch.span_m, (arch) => 0.16 * arch.span_m, 0.01, THICKNESS],
      [`${table}.voussoirs`, "Voussoirs", 5, 80, 1, VOUSSOIRS],
    ]),
    ["column.height_m", "Height (m)", 0.5, 20, 0.1, "Of two equal shapes the larger one is harder to overturn."],
    ["column.width_m", "Width (m)", 0.1, 4, 0.01, "Width over height is about the push in g at which the column begins to rock."],
  ],
  ground: [
    ...PULSES.flatMap(([pulse, , keys = []]) => [
      [`ground.${pulse}.amplitude_g`, "Amplitude (g): minus pushes right", -2, 2, 0.001, "Largest ground acceleration. The ground goes left, the structure stays behind: it is pushed to the right."],
      [`ground.${pulse}.duration_s`, "Duration (s)", 0.05, 3, 0.005, "Longer pulses push further: they overturn at a smaller amplitude."],
      ...keys.map((key) => [`ground.${pulse}.${key}`, ...WAVE_TRAIN[key]]),
    ]),
    ["ground.record.scale", "Factor on the record", 0.05, 20, 0.01, "All accelerations of the record times this."],
  ],
  model: [
    ["free_hinges.friction_coefficient", "Friction coefficient", 0.3, 1.5, 0.01, FRICTION],
    ["elastic_joints.normal_stiffness_gpa_m", "Normal stiffness (GPa/m)", 0.5, 200, 0.5, "Stress that closes a joint by a metre: about 1 for soft mortar, 100 for dry stone."],
    ["elastic_joints.friction_coefficient", "Friction coefficient", 0.3, 1.5, 0.01, FRICTION],
  ],
};

/** Returns the first scenario with other numbers or another model. */
const startWith = (...changes) => changes.reduce((text, [from, to]) => text.replace(from, to), START.slice(START.indexOf("[arch]")));
/** The examples of the recipes: title, scenario, study. */
const EXAMPLES = JSON.parse(document.getElementById("examples").textContent);
/** Returns the scenario of an example, under a pulse of this amplitude. */
const exampleWith = (amplitude_g, start) => EXAMPLES.find(({ title }) => title.startsWith(start)).scenario.replace(/(amplitude_g = )\S+/, `$1${amplitude_g}`);

/** The questions: title, a sentence, its document, the scenarios to compare, and a study. Without scenarios the reader gives a file. */
const QUESTIONS = [
  ["Which push fells it?", "At 0.38 g this arch comes back, at 0.39 g it falls. A search then finds the first push that fells it, and marks it at the slider.", "choose",
    [startWith(["36", "16"], ["-0.35", "-0.38"]), startWith(["36", "16"], ["-0.35", "-0.39"])], "threshold"],
  ["Stronger, yet it survives", "A push of 0.47 g fells this column of drums, one of 0.60 g does not: surviving one motion is no safety margin.", "questions", [0.47, 0.6].map((amplitude_g) => exampleWith(amplitude_g, "Column of drums"))],
  ["Twice as large", "The pulse that fells an arch of 5 m radius does not fell one of 10 m with the same shape. Size helps.", "maps",
    [startWith(["-0.35", "-0.45"]), startWith(["-0.35", "-0.45"], ["5.0", "10.0"])]],
  ["Four hinges or all joints?", "Four fixed hinges are fast to compute, but stone opens at any joint: compare both answers.", "choose", [startWith(["[free_hinges]\n\n", ""]), startWith()]],
  ["On piers", "An arch rarely stands on the ground. Piers sway with it, and turn about their toes; a load beside the crown makes one direction the weaker one.", "shapes", [exampleWith(-0.35, "Pointed arch on piers")]],
  ["Your record", "Choose or drop a file of ground accelerations: AT2 of PEER, ASC of ESM, or a table.", "records", null],
];

/** The studies: name, label, purpose. */
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
