// Files that the reader adds: records, and scenarios. Each is read before anything changes.

const MOST_BYTES = 16 << 20;
/** Names and contents of the record files that the reader has added. */
const files = {};

const recordTable = (name) => `[ground.record]\nfile = ${JSON.stringify(name)}\n${TABLE_FILE.test(name) ? COLUMNS : ""}scale = 1.0\n`;

/** Makes a record the ground motion. */
function useRecord(name) {
  const text = find("text").value;
  return edit(exchange(text, groundTables(text), [groundName(), RECORD + name], recordTable(name), []));
}

/** Returns the reason for which a file is refused, or "". `contents` is its text. */
async function refusal({ name, size }, contents) {
  if (size > MOST_BYTES) return `it has ${(size / 1048576).toFixed(0)} MB; this page takes files of at most 16 MB: use the program, or cut the file`;
  if (contents.includes("\u0000")) return "it is not a text, so no record that this page reads";
  const isScenario = name.endsWith(".toml");
  const text = isScenario ? contents : START.slice(0, START.indexOf("[ground")) + recordTable(name);
  const answer = await askFile({ scenario: text, files: { ...files, [name]: contents } });
  const wrong = answer?.errors[0]?.message ?? "";
  // A scenario may name files that are not here yet, and the reader gives the columns of a table.
  const isLater = isScenario ? !wrong.includes("not valid TOML") : TABLE_FILE.test(name) && /^[\s"']*[-+.\d]+(e[-+]?\d+)?["']?\s*([,;\s]|$)/im.test(contents);
  return isLater ? "" : wrong;
}

/** Adds files. A scenario opens. A single record becomes the ground motion, unless the scenario names files already. */
async function addFiles(added) {
  const refused = [];
  const records = [];
  let scenario = null;
  for (const file of added) {
    const contents = file.size > MOST_BYTES ? "" : await file.text();
    const wrong = await refusal(file, contents);
    if (wrong) refused.push({ message: `${file.name} is refused, and nothing is changed: ${wrong}` });
    else if (file.name.endsWith(".toml")) scenario = contents;
    else {
      // Scenarios of the repository name a folder.
      files[file.name] = files[`records/${file.name}`] = contents;
      records.push(file.name);
    }
  }
  showFiles();
  if (refused.length > 0) return showErrors(refused, false);
  const text = find("text").value;
  const namesFiles = hasTable(text, "suite") || text.includes("slv_records");
  if (scenario !== null) return edit(scenario);
  if (records.length === 1 && !namesFiles) return useRecord(records[0]);
  return computeRun();
}

/** Returns the names of the records that are here. */
const recordNames = () => Object.keys(files).filter((name) => !name.includes("/"));

/** Lists the records, and offers them among the ground motions. */
function showFiles() {
  const names = recordNames();
  find("files").textContent = names.length > 0 ? `Here: ${names.join(", ")}. Choose one above; the study Suite takes all.` : "";
  for (const name of names) {
    const value = `record:${name}`;
    const old = [...find("ground").options].find((option) => option.value === value);
    if (old) old.className = "";
    else find("ground").append(new Option(`Record: ${name}`, value));
  }
}

find("record").addEventListener("change", () => addFiles([...find("record").files]));

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
    addFiles([...event.dataTransfer.files]);
  }));
}
takeDrops(document);
