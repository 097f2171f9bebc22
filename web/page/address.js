// The address holds the scenario with a check sum. Each step of the reader has its entry in the history of the browser, so that Back undoes it.

/** Changes by the same control without such a pause are one step. */
const PAUSE_MS = 1000;
const CHECK = "#check=";

/** Returns the CRC-32 of a text, in hexadecimal. */
function checkSum(text) {
  let sum = -1;
  for (const byte of new TextEncoder().encode(text)) {
    sum ^= byte;
    for (let bit = 0; bit < 8; bit += 1) sum = (sum >>> 1) ^ (sum & 1 && 0xedb88320);
  }
  return (~sum >>> 0).toString(16).padStart(8, "0");
}

const addressOf = (text) => (text === START ? location.pathname + location.search : `${CHECK}${checkSum(text)}&scenario=${encodeURIComponent(text)}`);

function sayOfLink(words) {
  find("broken").textContent = words;
  find("broken").hidden = !words;
}

/** Returns the scenario in the address, the first scenario if there is none, or the present one if the address is damaged. */
function textOfAddress() {
  sayOfLink("");
  const link = location.hash;
  if (link.length < 2) return START;
  const isChecked = link.startsWith(CHECK) || CHECK.startsWith(link);
  const [, sum, encoded] = link.match(/^#check=([0-9a-f]{8})&scenario=(.*)$/) ?? [];
  try {
    const text = decodeURIComponent(isChecked ? encoded : link.slice(1));
    if (isChecked && sum !== checkSum(text)) throw new Error("the check sum differs");
    if (!isChecked) sayOfLink("This is an older link, not checked: if it was shortened, the text below is another scenario than the one that was sent.");
    return text;
  } catch {
    sayOfLink("This link is damaged, perhaps shortened: the text below is not that of the link. Ask for the link again.");
    return find("text").value || START;
  }
}

/** Number of steps that can be undone, the control and the time of the last change, and the timer of its address. */
const steps = { undone: history.state?.steps ?? 0, source: null, time_ms: -Infinity, later: null };

function showSteps(count) {
  steps.undone = count;
  find("undo").disabled = count === 0;
}

/** Writes an entry of the history of the browser, by `pushState` or `replaceState`. Hosts of frames may refuse it: there, changes have no address. */
function write(by, address) {
  try {
    history[by]({ steps: steps.undone }, "", address);
  } catch (error) {
    if (error.name !== "SecurityError") throw error;
    showSteps(0);
  }
}

/** Keeps the present text in the address. Returns true if a new step begins. Without a source each change is a step. */
function keepAddress(source) {
  const now = performance.now();
  const goesOn = source !== null && source === steps.source && now - steps.time_ms < PAUSE_MS;
  Object.assign(steps, { source, time_ms: now });
  const address = addressOf(find("text").value);
  sayOfLink("");
  const put = () => write("replaceState", address);
  // Browsers refuse many changes of the address in a row.
  if (goesOn) {
    clearTimeout(steps.later?.timer);
    steps.later = { put, timer: setTimeout(put, 200) };
  } else {
    putNow();
    if (address === (location.hash || location.pathname + location.search)) return false;
    showSteps(steps.undone + 1);
    write("pushState", address);
  }
  return !goesOn;
}

/** Puts the last text into the address at once, if that is still to come. */
function putNow() {
  clearTimeout(steps.later?.timer);
  steps.later?.put();
  steps.later = null;
}

function undo() {
  putNow();
  if (steps.undone > 0) history.back();
}

/** Undoes and repeats steps by keys, also in a document inside this one. */
function takeUndo(on) {
  on.addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || !["z", "y"].includes(key)) return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) history.forward();
    else undo();
  });
}
takeUndo(document);
find("undo").addEventListener("click", undo);
find("reset").addEventListener("click", () => edit(START));

addEventListener("popstate", ({ state }) => {
  clearTimeout(steps.later?.timer);
  Object.assign(steps, { source: null, later: null });
  // A link that was opened in this page is a step of its own.
  showSteps(state?.steps ?? steps.undone + 1);
  if (!state) write("replaceState");
  find("text").value = textOfAddress();
  before = shown;
  computeRun();
});
