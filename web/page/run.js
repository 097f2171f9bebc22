// The history: its headline, its picture and its curves, which are those of the report of the program.

const STOPPED = "Stopped before the repetitions: no verdict.";
const NOT_COMPUTED = "Not computed yet: no verdict.";
const NOT_REPEATED = "Not repeated yet: no verdict.\nThis is one history. Its repetitions with other steps, and its mirror image, decide whether its outcome is certain: they follow once you pause.";

let askRun;
let changes = 0;

/** Shows the answer: its first line as the headline, the others below it. Lines that the program has broken are whole here. */
function sayAnswer(words, isFinal) {
  const [headline, ...more] = words.replace(/\n {4,}/g, " ").split("\n").map((line) => line.trim());
  // Screen readers read what changes.
  if (find("answer").textContent !== headline) find("answer").textContent = headline;
  find("answer").classList.toggle("open", !isFinal);
  // On this page a control takes the place of the command.
  const withControl = (line) => line.replace(/^run `archrock \S+ FILE --set ([\w.]+)=([\d.]+)`$/, "tick \"joints may slip\", and set $2");
  find("conditions").replaceChildren(...more.map((line) => Object.assign(document.createElement("li"), { textContent: withControl(line) })));
}

function showErrors(errors, isStale = errors.length > 0) {
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
  markStale(isStale);
  if (errors.length === 0) return;
  const more = errors.length > 1 ? `; ${errors.length - 1} more below the text` : "";
  // A slider may have gone beyond the structures that stand.
  const remedy = document.activeElement.closest(".slider") ? " (move the slider back, or change another one)" : "";
  find("status").textContent = `${errors[0].message}${more}${remedy}`;
}

/** Marks the picture as that of an earlier scenario. */
function markStale(isStale) {
  document.body.classList.toggle("stale", isStale);
}

/** Marks a study of an earlier scenario. */
function markStudy() {
  const isEarlier = studied !== null && studied !== find("text").value;
  find("earlier").hidden = !isEarlier;
  find("study-page").classList.toggle("stale", isEarlier);
}

/** The history that is shown, for the comparison with the next one: its scenario and its largest rotation over time. */
let shown = null;
/** The history before the last step. */
let before = null;

/** Names a history and the one before it by what differs between them. */
function namesOf(now, then) {
  const numbers = changedNumbers(then, now);
  if (numbers?.length === 1) {
    const [[key]] = numbers;
    return [now, then].map((scenario) => `${key} = ${valueOf(scenario, key)}`);
  }
  const model = (scenario) => MODELS.findLast(([name]) => !name || scenario[name])[1].split(":")[0].toLowerCase();
  return model(now) === model(then) ? ["now", "before"] : [model(now), model(then)];
}

/** The parts of a report that this page shows, by the elements that hold them. */
const PARTS = { picture: "section:first-of-type", curves: "section:nth-of-type(2)", told: "section:last-of-type" };

/** Makes the parts of the first report parts of this page, with its style and its scripts. */
function adopt(report) {
  const parts = Object.entries(PARTS).map(([id, part]) => [id, report.querySelector(`main > ${part}`)]);
  for (const [id, part] of parts) find(id).replaceChildren(part);
  // What the reader sets once is beside the other controls.
  find("view-choices").append(...["exaggeration", "thrust", "ride", "sizes"].map((id) => find(id).closest("label")));
  find("legend").append(...find("picture").querySelectorAll(".hint"));
  help("How many times as large as it is the movement is drawn.", find("exaggeration"));
  help("The line along which the stones press on each other.", find("thrust"));
  help("Off: the ground moves in the picture. On: the picture moves with the ground.", find("ride"));
  help("The dimensions of the structure.", find("sizes"));
  const again = (part) => Object.assign(document.createElement(part.localName), { textContent: part.textContent });
  document.head.prepend(...[...report.querySelectorAll("style")].map(again));
  const data = Object.assign(again(report.getElementById("data")), { id: "data", type: "application/json" });
  document.body.append(data, ...[...report.querySelectorAll("script:not([type])")].map(again));
  find("play").addEventListener("click", () => (plays = window.archrock.shown().playing));
  find("time").addEventListener("input", () => (plays = false));
}

/** What the reader has set for the picture, by the fields. */
const chosen = {};
find("view-choices").addEventListener("input", ({ target, isTrusted }) => {
  if (isTrusted) chosen[target.id] = target.type === "checkbox" ? target.checked : target.value;
});

/** Sets the picture of a next history as the reader has set that of the last one. A fall is drawn as large as it is. */
function setView({ fall_end }) {
  for (const [id, value] of Object.entries({ ...(fall_end && { exaggeration: 1 }), ...chosen })) {
    const field = find(id);
    field[field.type === "checkbox" ? "checked" : "value"] = value;
    for (const name of ["input", "change"]) field.dispatchEvent(new Event(name));
  }
}

const still = matchMedia("(prefers-reduced-motion: reduce)");
/** Whether histories play by themselves: until the reader stops one, or prefers reduced motion. */
let plays = !still.matches;
let resting = 0;
/** Plays a history again and again, with a rest at the end. */
setInterval(() => {
  const { archrock } = window;
  if (!plays || !archrock || document.hidden) return;
  const { time, playing } = archrock.shown();
  resting = playing || time < archrock.times.at(-1) ? 0 : resting + 1;
  if (resting > 3) archrock.play(true);
}, 500);

/** Shows a report. A first history of a scenario plays from its start once the reader pauses; until then its worst instant is shown. */
async function showReport({ files: { "report.html": html }, scenario }, isFirst) {
  const report = new DOMParser().parseFromString(html, "text/html");
  const own = JSON.parse(report.getElementById("data").textContent);
  if (before) own.before = { curve: before.curve, names: namesOf(scenario, before.scenario) };
  report.getElementById("data").textContent = JSON.stringify(own);
  // The page answers its reader in between.
  await new Promise((resolve) => setTimeout(resolve));
  find("notes").replaceChildren(...report.querySelectorAll("header > :is(#directions, .warning, #what)"));
  if (!window.archrock) {
    adopt(report);
    setView(own);
    await window.archrock.ready;
  } else {
    const { time, playing } = window.archrock.shown();
    find("told").replaceChildren(report.querySelector(`main > ${PARTS.told}`));
    const complete = window.archrock.renew(own);
    setView(own);
    if (!isFirst) window.archrock.seek(time);
    else if (playing) window.archrock.play(false);
    await complete;
  }
  shown = { scenario, curve: window.archrock.largest() };
}

/** Changes the text of the scenario, and computes it. Changes by the same source without a pause are one step. */
function edit(text, source = null, isPassing = false) {
  find("text").value = text;
  if (keepAddress(source)) before = shown;
  return computeRun(isPassing);
}

const request = (more) => ({ scenario: find("text").value, files, ...more });

// The rounds of a history of a row of blocks: its first sways, for a picture at once, all of it, and its repetitions. Other histories are whole at once.
const FIRST_SWAYS = { no_repeat: true, sways_only: true };
const WHOLE = { no_repeat: true, pause_ms: 300 };
// Browsers let a stopped worker compute for some seconds: repetitions begin once the reader pauses.
const REPEATED = { no_repeat: false, pause_ms: PAUSE_MS };

/** Computes the history in rounds; without repetitions if it is `passing`, on the way to another scenario. */
async function computeRun(isPassing = false) {
  const change = ++changes;
  markStudy();
  showStatics();
  // What was wrong with an earlier text.
  for (const part of ["study-", "save-"]) if (find(`${part}stop`).hidden) find(`${part}status`).textContent = "";
  for (const { pause_ms, ...round } of isPassing ? [WHOLE] : [FIRST_SWAYS, WHOLE, REPEATED]) {
    const isFirst = isPassing || round.sways_only;
    if (!isFirst) await new Promise((resolve) => setTimeout(resolve, pause_ms));
    if (!isFirst && change !== changes) return;
    const answer = await askRun(request({ study: "run", names: ["report.html"], ...round }));
    if (!answer || (!isFirst && change !== changes)) return;
    if (answer.scenario) showScenario(answer.scenario);
    showErrors(answer.errors);
    if (answer.errors.length > 0) return sayAnswer("No verdict: the scenario below has an error.", false);
    const isFinal = !round.no_repeat || !(answer.scenario.free_hinges || answer.scenario.elastic_joints);
    document.body.classList.toggle("unrepeated", !isFinal);
    sayAnswer(isFinal ? answer.answer : NOT_REPEATED, isFinal);
    await showReport(answer, isFirst);
    page.answer = answer;
    if (isFirst && change === changes) playSoon();
    if (isFinal) return;
  }
}

let soon;
/** Plays the history from its start, a moment after the last change. */
function playSoon() {
  clearTimeout(soon);
  if (!plays) return;
  soon = setTimeout(() => {
    window.archrock.seek(window.archrock.times[0]);
    window.archrock.play(true);
  }, 400);
}

let typed;
find("text").addEventListener("input", () => {
  if (keepAddress("text")) before = shown;
  clearTimeout(typed);
  typed = setTimeout(computeRun, 250);
});
