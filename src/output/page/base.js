// The data of a page, which are in #data, and the colours of its style.
const find = (id) => document.getElementById(id);
const data = JSON.parse(find("data").textContent);
// In print pages are light, without controls and commands; scripts that fit a page to its sheet measure it with this class.
for (const [event, prints] of [["beforeprint", true], ["afterprint", false]]) {
  if (!document.body.classList.contains("host")) window.addEventListener(event, () => document.documentElement.classList.toggle("print", prints));
}
function buffer(text) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = characters.charCodeAt(i);
  return bytes.buffer;
}
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const farthest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
/** Phrases about the numbers of a case, by column; empty for those that its heading has, or that concern the computation. */
const PHRASES = {
  model: "",
  outcome: "",
  factor: "",
  energy_defect_ratio: "",
  overturning_sway: "to the #",
  outcome_time_s: "ends at # s",
  impacts: "# impacts",
  peak_rotation_rad: "largest rotation # rad",
  peak_rotation_over_critical: "largest rotation # times that of overturning",
  peak_potential_over_barrier: "largest energy # times that of overturning",
  thrust_excess_ratio: "thrust line up to # thicknesses outside",
  friction_demand: "needs a friction coefficient of #",
};
/** A cell of a column in words, with its unit and four digits; empty if it says nothing about the case. */
function inWords(column, cell) {
  if (cell === "as_given") return "";
  const number = Number(cell);
  const shown = Number.isFinite(number) ? String(Number(number.toPrecision(4))) : String(cell).replaceAll("_", " ");
  const unit = column.match(/_(s|rad|deg|m|mm|g|hz|n|j|mpa)$/)?.[1] ?? "";
  const name = column.slice(0, column.length - (unit ? unit.length + 1 : 0)).replaceAll("_", " ");
  return (PHRASES[column] ?? `${name} # ${unit}`.trim()).replace("#", shown).replace(/^1 impacts$/, "1 impact");
}

/** Copies the command of a page. */
async function copyCommand() {
  try {
    await navigator.clipboard.writeText(find("command").textContent);
    find("copy").textContent = "Copied";
  } catch {
    // Where pages may not write to the clipboard, the text is selected for the keyboard.
    getSelection().selectAllChildren(find("command"));
  }
}
