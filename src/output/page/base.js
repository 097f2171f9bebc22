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
/** The name of a column in words, with its unit. */
const inWords = (column) => column.replace(/_(s|rad|deg|m|mm|g|hz|n|j|mpa)$/, " ($1)").replaceAll("_", " ");

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
