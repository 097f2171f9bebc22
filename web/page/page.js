// Saves, questions and the start of the page.

function save(name, contents) {
  const type = { csv: "text/csv", svg: "image/svg+xml", html: "text/html" }[name.split(".").at(-1)] ?? "text/plain";
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([contents], { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

for (const button of document.querySelectorAll("[data-save]")) {
  button.addEventListener("click", async () => {
    const name = button.dataset.save;
    if (name.endsWith(".toml")) return save(name, find("text").value);
    if (name.endsWith(".png")) return document.querySelector("canvas").toBlob((picture) => save(name, picture));
    const answer = await askFile(request({ study: "run", names: [name] }));
    if (answer?.files[name]) save(name, answer.files[name]);
    else if (answer) find("save-status").textContent = `Nothing is saved: ${answer.errors[0].message}`;
  });
}

// Questions and examples.

/** Returns a link to a document of the site, or its name where the documents are not beside the page. */
function documentLink(name) {
  const folder = document.querySelector("meta[name=documents]").content;
  if (!folder) return Object.assign(document.createElement("span"), { className: "hint", textContent: `docs/${name}.md` });
  return Object.assign(document.createElement("a"), { href: `${folder}${name}.html`, target: "_blank", textContent: "Read more" });
}

/** Opens scenarios one after the other, so that the last one is compared with the one before it; then computes a study. */
async function open(texts, study) {
  scrollTo({ top: 0, behavior: "smooth" });
  plays = !still.matches;
  for (const text of texts.slice(0, -1)) await edit(text, null, true);
  const complete = edit(texts.at(-1));
  if (texts.length === 1) before = null;
  if (!study) return complete;
  find("study").value = study;
  purpose();
  return computeStudy(study);
}

for (const [title, sentence, name, texts, study] of QUESTIONS) {
  const card = Object.assign(document.createElement("article"), { className: "card" });
  const button = Object.assign(document.createElement("button"), { type: "button", textContent: title });
  button.addEventListener("click", () => (texts ? open(texts, study) : find("record").click()));
  card.append(button, Object.assign(document.createElement("p"), { textContent: sentence }), documentLink(name));
  find("questions").append(card);
}

fill(find("example"), EXAMPLES.map(({ title }, number) => [number, title]));
find("example").addEventListener("change", () => {
  const { scenario, study } = EXAMPLES[find("example").value];
  find("example").value = "";
  open([scenario], STUDIES.some(([name]) => name === study) ? study : null);
});

// The start.

/** For scripts: the last answers, and functions that change the scenario and compute. */
const page = { answer: null, study: null, edit, computeStudy, files, ask: (request) => askStudy(request) };
window.page = page;

/** Returns the reason why the page cannot start, in words. */
function whyNot(error) {
  if (typeof WebAssembly === "undefined" || /disallowed|Content.Security.Policy|blocked by CSP|unsafe-eval/i.test(error.message)) {
    return `This browser or this host refuses WebAssembly, in which the page computes: ${ALONE}.`;
  }
  if (error instanceof WebAssembly.CompileError) {
    return "This browser is too old for this page: it has no WebAssembly with SIMD. Update the browser, or install the program.";
  }
  return `The page cannot start: ${error.message}. From a folder on disk, open archrock.html, which needs no other file.`;
}

find("refused")?.remove();
try {
  const module = await compile();
  const work = (part) => ["status", "progress", "stop"].map((name) => find(`${part}${name}`));
  askRun = createQueue(module, work(""), {
    read: showScenario,
    slow() {
      markStale(true);
      sayAnswer(NOT_COMPUTED, false);
    },
    stopped: () => sayAnswer(STOPPED, false),
  });
  askStudy = createQueue(module, work("study-"));
  askFile = createQueue(module, work("save-"));
  askStatics = createQueue(module, helperElements());
  startHelpers(module);
  showSteps(steps.undone);
  write("replaceState");
  find("text").value = textOfAddress();
  await computeRun();
} catch (error) {
  find("status").textContent = "";
  sayOfLink(whyNot(error));
}
