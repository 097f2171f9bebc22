// Checks of the page to try, in the page itself. `part` chooses them; the verdict goes to the test at `address`.
const failures = [];
let passed = 0;
const verify = (holds, what) => {
  if (holds) passed += 1;
  else failures.push(what);
};
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Waits until something holds, at most a minute. */
async function until(holds, what) {
  for (const begin = performance.now(); !holds(); await wait(20)) {
    if (performance.now() - begin > 60000) throw new Error(`in vain: ${what}`);
  }
  passed += 1;
}

const element = (id) => document.getElementById(id);
const event = (target, name) => target.dispatchEvent(new Event(name, { bubbles: true }));
const inside = (id) => element(id).querySelector("iframe:not(.waiting)").contentWindow;
const verdictShown = () => inside("run").document.getElementById("outcome").textContent;
const firstLine = (words) => words.split("\n")[0];

/** Does something, and waits for the picture that follows. */
async function afterwards(act, what) {
  page.answer = null;
  act();
  await until(() => page.answer, what);
}

/** Makes a choice, and waits for the picture that follows. */
const choose = (id, value) =>
  afterwards(() => {
    element(id).value = value;
    event(element(id), "change");
  }, `${id} ${value}`);

/** Rows of blocks have the same bits. Steps of four links and columns depend on `pow` of the machine, and their results in digits that are not printed. */
const equal = (one, other, bits, ratio) => Object.is(one, other) || (!bits && Math.abs(one - other) <= 1e-9 + ratio * Math.abs(other));

/** A friction coefficient is a ratio to the force in a joint, which may be almost unloaded: its error is as many times larger, here up to 50. */
const ratioOf = (path) => (path.includes("friction") ? 1e-6 : 1e-8);

function differences(one, other, bits, path) {
  const apart = [`${path}: ${one} ${other}`];
  if (typeof one !== typeof other) return apart;
  if (typeof one === "number") return equal(one, other, bits, ratioOf(path)) ? [] : apart;
  if (typeof one !== "object" || !one || !other) return one === other ? [] : apart;
  const keys = new Set([...Object.keys(one), ...Object.keys(other)]);
  return [...keys].flatMap((key) => differences(one[key], other[key], bits, `${path}.${key}`));
}

/** The rows of a table, with their cells by the names of the columns. */
function cells(table) {
  const [header, ...rows] = table.trim().split("\n").map((row) => row.split(","));
  const value = (cell) => (cell === "" || isNaN(cell) ? cell : Number(cell));
  return rows.map((row) => Object.fromEntries(row.map((cell, index) => [header[index] ?? index, value(cell)])));
}

const PARTS = {
  async bits() {
    let equalBits = 0;
    for (const { name, study, scenario, files, expected } of data) {
      const names = Object.keys(expected.tables);
      const answer = await page.ask({ study, scenario, files, names, no_repeat: study === "run" });
      const what = `${name} ${study}`;
      verify(answer.errors.length === 0, `${what}: ${JSON.stringify(answer.errors)}`);
      verify(answer.words === expected.words, `${what}: ${answer.words}\n${expected.words}`);
      const bits = Boolean(answer.scenario.free_hinges || answer.scenario.elastic_joints);
      const found = differences(answer.summary, expected.summary, bits, what);
      for (const table of names) found.push(...differences(cells(answer.files[table]), cells(expected.tables[table]), bits, `${what} ${table}`));
      verify(found.length === 0, found.slice(0, 5).join("; "));
      equalBits += bits;
    }
    verify(equalBits === 7, `${equalBits} scenarios of rows of blocks`);
  },

  async readers() {
    const text = element("text");
    const slider = (key) => element(`number-${key}`);
    // Sliders change the text, and the text moves the sliders.
    await afterwards(() => {
      const number = slider("ground.half_sine.amplitude_g");
      number.nextSibling.value = -0.35;
      event(number.nextSibling, "input");
    }, "a slider");
    verify(text.value.includes("amplitude_g = -0.35\n"), text.value);
    verify(firstLine(page.answer.words) === firstLine(data.slider), `${page.answer.words}\n${data.slider}`);
    verify(verdictShown() === firstLine(data.slider), verdictShown());
    await until(() => decodeURIComponent(location.hash.slice(1)) === text.value, "the address");
    verify([...document.querySelectorAll(".slider")].filter((row) => row.offsetParent).length === 6, "sliders of the arch and its pulse");
    const tasks = [];
    new PerformanceObserver((list) => list.getEntries().forEach(({ duration }) => tasks.push(duration))).observe({ type: "longtask" });
    await afterwards(() => page.edit(text.value.replace("-0.35", "-0.36")), "a text");
    verify(slider("ground.half_sine.amplitude_g").value === "-0.36", "the slider follows the text");
    // The view of the reader stays.
    const box = inside("run").document.getElementById("sizes");
    box.click();
    await afterwards(() => page.edit(text.value.replace("-0.36", "-0.35")), "the view");
    verify(inside("run").document.getElementById("sizes").checked === false, "dimensions stay hidden");
    verify(Math.max(0, ...tasks) < 150, `tasks of ${tasks} ms`);

    // Sentences name no options of the program.
    const free = text.value.trimEnd() + "\n[free_hinges]\n";
    for (const scenario of [text.value, text.value.replace("-0.35", "-3"), free]) {
      const run = await page.ask({ study: "run", scenario, files: {}, names: ["report.html"], no_repeat: true });
      const threshold = scenario === free ? { words: "" } : await page.ask({ study: "threshold", scenario, files: {}, names: [] });
      const said = run.words + run.files["report.html"].match(/<div class="words"[^>]*>[^]*?<\/div>/)[0] + threshold.words;
      // Only commands between backquotes have options.
      const sentences = said.replaceAll(/`archrock [^`]*`/g, "");
      verify(said.length > 1000 && !/--[a-z]/.test(sentences) && !said.includes("was not repeated"), said);
    }

    // Keys of dotted and of inline tables have sliders and choices, too.
    const before = text.value;
    const both = "arch.mean_radius_m = 5\narch.thickness_ratio = 0.15\narch.embrace_deg = 180\n[ground]\nhalf_sine = { amplitude_g = -0.3, duration_s = 0.3 }\n";
    await afterwards(() => page.edit(both), "dotted keys");
    for (const [key, value] of [["arch.thickness_ratio", 0.2], ["ground.half_sine.amplitude_g", -0.4]]) {
      await afterwards(() => {
        slider(key).value = value;
        event(slider(key), "input");
      }, key);
    }
    await choose("ground", "one_sine");
    verify(text.value === both.replace("ratio = 0.15", "ratio = 0.2").replace("half_sine = { amplitude_g = -0.3", "one_sine = { amplitude_g = -0.4"), text.value);
    verify(await choose("structure", "column").then(() => !text.value.includes("arch") && text.value.includes("[ground]")), text.value);

    // Choices keep the keys that both have, and return with their own.
    const start_s = `${before.trimEnd()}\nstart_s = 0.5\n\n[impact]\nmodel = "prescribed"\nrestitution = 0.6\n`;
    await afterwards(() => page.edit(start_s), "a start");
    await choose("ground", "ricker");
    await choose("model", "free_hinges");
    verify(text.value.includes("start_s = 0.5") && !text.value.includes("[impact]"), text.value);
    await choose("structure", "pointed_arch");
    verify(text.value.includes("voussoirs = 36"), text.value);
    await choose("structure", "arch");
    await choose("model", "");
    await choose("ground", "half_sine");
    verify(text.value === start_s, `${text.value}\n${start_s}`);

    // Every pulse, with the keys of its own, which the next one may not have.
    let number = 1;
    for (const pulse of [...element("ground").options].map((option) => option.value)) {
      await choose("ground", pulse);
      verify(text.value.includes(`[ground.${pulse}]`) && element("errors").children.length === 0, `${pulse}: ${text.value} ${element("errors").textContent}`);
      for (const key of ["gamma", "cycles", "phase_deg"].filter((key) => slider(`ground.${pulse}.${key}`))) {
        number += 1;
        await afterwards(() => {
          slider(`ground.${pulse}.${key}`).value = number;
          event(slider(`ground.${pulse}.${key}`), "input");
        }, key);
        verify(text.value.includes(`${key} = ${number}\n`), text.value);
      }
    }
    await choose("ground", "half_sine");
    verify(text.value === start_s, `${text.value}\n${start_s}`);

    // Ends of sliders are structures that stand.
    for (const kind of ["pointed_arch", "elliptic_arch", "arch"]) {
      await choose("structure", kind);
      const whole = text.value;
      for (const { nextSibling: range } of [...document.querySelectorAll("[data-part=structure] input[type=number]")].filter((field) => field.offsetParent)) {
        for (const end of [range.min, range.max]) {
          await afterwards(() => {
            range.value = end;
            event(range, "input");
          }, `${range.previousSibling.id} ${end}: ${element("status").textContent}`);
          await afterwards(() => page.edit(whole), "the middle");
        }
      }
    }
    await afterwards(() => page.edit(before), "the arch");

    // Other structures, pulses and models.
    for (const [id, value, table] of [
      ["ground", "one_cosine", "[ground.one_cosine]"],
      ["model", "free_hinges", "[free_hinges]"],
      ["model", "elastic_joints", "[elastic_joints]"],
      ["model", "", "[arch]"],
      ["structure", "column", "[column]"],
      ["structure", "arch", "[arch]"],
      ["ground", "half_sine", "[ground.half_sine]"],
    ]) {
      await choose(id, value);
      verify(text.value.includes(table) && element("errors").children.length === 0, `${value}: ${text.value} ${element("errors").textContent}`);
    }
    verify(!text.value.includes("[free_hinges]") && !text.value.includes("[column]"), text.value);
    await choose("model", "free_hinges");
    await afterwards(() => document.querySelector(".switch input").click(), "slip");
    verify(text.value.includes("friction_coefficient = 0.8"), text.value);
    // The picture comes first, repetitions after it.
    await until(() => page.answer?.words.includes("repeated ("), "repetitions");

    // Errors have their places, and the last picture stays.
    const good = text.value;
    text.value = good.replace("embrace_deg = 180.0", "embrace_deg = 500");
    event(text, "input");
    await until(() => element("errors").textContent.includes("line "), "an error");
    verify(/line \d+, column \d+: `embrace_deg = 500`/.test(element("errors").textContent), element("errors").textContent);
    verify(inside("run").document.getElementById("stage") !== null, "the last picture");
    element("errors").querySelector("button").click();
    verify(text.selectionStart > 0 && document.activeElement === text, "the cursor is at the error");
    await page.edit("[arch");
    verify(element("errors").textContent.includes("not valid TOML"), element("errors").textContent);
    await afterwards(() => page.edit(good), "a mended text");
    verify(element("errors").children.length === 0, element("errors").textContent);

    // Records.
    await afterwards(() => page.edit(good.replace(/\n\[free_hinges\][^[]*/, "\n")), "four links");
    await afterwards(() => {
      const dropped = new DataTransfer();
      dropped.items.add(new File([data.record], "synthetic.at2"));
      document.dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true, cancelable: true }));
    }, "a record");
    verify(page.answer.words === data.of_record, `${page.answer.words}\n${data.of_record}`);
    const large = new DataTransfer();
    large.items.add(new File([new Uint8Array(50e6)], "large.at2"));
    document.dispatchEvent(new DragEvent("drop", { dataTransfer: large, bubbles: true, cancelable: true }));
    await until(() => element("errors").textContent.includes("at most 16 MB"), "a large record");

    // Links.
    const link = "[column]\nheight_m = 4\nwidth_m = 0.8\n[ground.half_sine]\namplitude_g = 0.3\nduration_s = 1\n";
    await afterwards(() => (location.hash = encodeURIComponent(link)), "a link");
    verify(text.value === link && element("structure").value === "column", text.value);
    location.hash = "%E0%A4%A";
    await until(() => !element("broken").hidden, "a damaged link");
    verify(text.value === link, `a damaged link leaves the text: ${text.value}`);

    // Studies.
    const start = data.start;
    await afterwards(() => page.edit(start), "the arch");
    await page.computeStudy("threshold");
    verify(page.study.words === data.threshold, `${page.study.words}\n${data.threshold}`);
    verify(inside("study-page").document.getElementById("points") !== null, "the page of the threshold");
    await page.computeStudy("map");
    const map = inside("study-page");
    verify(map.document.getElementById("numbers").textContent.startsWith("pulse duration (s) 0.3, pulse amplitude (g) -0.35: comes to rest"), map.document.getElementById("numbers").textContent);
    verify(map.archrock.data.axes.map(({ values }) => values.length).join() === "49,33", "the finest map");
    verify(getComputedStyle(map.document.getElementById("command")).display === "none", "a command of the program");
    map.archrock.show([3, 4]);
    await afterwards(() => element("take").click(), "a cell");
    verify(/duration_s = 0\.0\d+/.test(text.value) && text.value.includes("amplitude_g = -"), text.value);
    verify(text.value.split("\n").length === start.split("\n").length, "the text keeps its lines");
    await afterwards(() => page.edit(start.replace(/\[ground[^]*/, '[ground.record]\nfile = "synthetic.at2"\n')), "the record again");
    await page.computeStudy("map");
    verify(page.study.words.includes("cells:"), page.study.words || element("study-status").textContent);
    verify(element("errors").children.length === 0, element("errors").textContent);

    // A map fills in from coarse to fine, and each cell is that of a map that is computed whole. A marked cell stays so.
    const own = `${start.replace("36", "12")}[free_hinges]\n[map]\nduration_s = { from = 0.1, to = 0.9, count = 13 }\namplitude_g = { from = 0.1, to = 0.9, count = 9 }\n`;
    await afterwards(() => page.edit(own), "an own map");
    const levels = [];
    const watch = setInterval(() => {
      const { archrock } = inside("study-page");
      const size = archrock.data.axes?.map(({ values }) => values.length).join();
      if (size === "7,7" && !archrock.stays()) archrock.keep([6, 0]);
      if (levels.at(-1) !== size) levels.push(size);
    }, 5);
    await page.computeStudy("map");
    await wait(20);
    clearInterval(watch);
    verify(levels.slice(-2).join(" ") === "7,7 13,9", levels.join(" "));
    verify(inside("study-page").archrock.chosen().join() === "12,0", inside("study-page").archrock.chosen().join());
    const whole = await page.ask({ study: "map", scenario: own, files: {}, names: ["map.html"] });
    verify(whole.words === page.study.words && whole.files["map.html"] === page.study.files["map.html"], `${whole.words}\n${page.study.words}`);
    await afterwards(() => page.edit(start), "the arch again");
    for (const study of ["spread", "capacity", "limit"]) {
      await page.computeStudy(study);
      verify(page.study.words.length > 50 && inside("study-page").document.getElementById("outcome").textContent.length > 10, study);
    }
    await page.computeStudy("verify");
    verify(element("study-status").textContent.includes("[demand"), element("study-status").textContent);
    page.study = null;
    await afterwards(() => element("add").click(), "a table for the check");
    await until(() => page.study?.files["verify.html"], `the check: ${element("study-status").textContent}`);
    verify(text.value.startsWith(start) && text.value.includes("[demand.slv]"), text.value);

    verify(element("earlier").hidden, "the check is that of the text");
    const changed = page.edit(start.replace("-0.35", "-0.36"));
    verify(!element("earlier").hidden && element("study-page").classList.contains("stale"), "an earlier study is marked at once");
    await changed;

    // A suite begins with the files that were given; an unlikely unit is doubted beside the verdict.
    page.files["given.csv"] = "t,a\n0,0\n0.1,4\n0.2,-4\n0.3,0\n";
    await page.computeStudy("suite");
    await afterwards(() => element("add").click(), "a suite");
    await until(() => page.study.files["suite.html"]?.includes("given.csv"), `the suite: ${element("study-status").textContent}`);
    await afterwards(() => page.edit(`${link.slice(0, link.indexOf("[ground"))}[ground.record]\nfile = "given.csv"\nunit = "g"\n`), "a record");
    verify(inside("run").document.querySelector("header .warning").textContent.includes("is its unit"), "the unit is doubted");

    // The case of a threshold changes numbers alone.
    const commented = `# A comment\n${start.replace("duration_s", "# another\nduration_s")}`;
    await afterwards(() => page.edit(commented), "comments");
    await page.computeStudy("threshold");
    await afterwards(() => element("take").click(), "a case");
    verify(text.value.replace(/amplitude_g = .*/, "") === commented.replace(/amplitude_g = .*/, "") && text.value !== commented, text.value);
    // The address follows a moment later.
    await wait(300);
    await afterwards(() => history.back(), "Back");
    verify(text.value === commented, text.value);

    // Long work shows its progress and stops.
    page.edit(`${link.replace("duration_s = 1", "duration_s = 3000\nstart_s = 1")}[simulation]\nduration_s = 900000\noutput_step_s = 1\n`);
    const many = "duration_s = { from = 0.1, to = 2, count = 400 }\namplitude_g = { from = 0.1, to = 2, count = 400 }\n";
    const long = page.ask({ study: "map", scenario: `${start}[map]\n${many}`, files: {} });
    await until(() => !element("study-stop").hidden && /takes some \d+ .*left/.test(element("study-status").textContent), "an estimate");
    element("study-stop").click();
    verify((await long) === null && element("study-status").textContent.startsWith("Stopped"), "stopped");
    await afterwards(() => page.edit(start), "work after a stop");

    // A page that is closed while it computes.
    const other = Object.assign(document.createElement("iframe"), { srcdoc: document.documentElement.outerHTML.replace(/<script type="module">const \[data[^]*/, "") });
    document.body.append(other);
    await until(() => other.contentWindow.page, "another page");
    other.remove();
    await afterwards(() => page.edit(start.replace("-0.35", "-0.34")), "this page");
  },

  async narrow() {
    // A browser that refuses the module.
    const old = Object.assign(document.createElement("iframe"), { src: `${address}old/` });
    document.body.append(old);
    await until(() => old.contentDocument?.getElementById("broken")?.hidden === false, "a refused module");
    verify(old.contentDocument.getElementById("broken").textContent.includes("Update the browser"), old.contentDocument.getElementById("broken").textContent);
    const frame = Object.assign(document.createElement("iframe"), { src: `${address}page`, width: 390, height: 840 });
    document.body.append(frame);
    await until(() => frame.contentWindow.page?.answer, "the narrow page");
    const { document: narrow } = frame.contentWindow;
    verify(narrow.documentElement.scrollWidth <= 390, `${narrow.documentElement.scrollWidth} px wide`);
    const walker = narrow.createTreeWalker(narrow.body, NodeFilter.SHOW_TEXT);
    const small = [];
    while (walker.nextNode()) {
      const { parentElement: parent } = walker.currentNode;
      const size = parseFloat(getComputedStyle(parent).fontSize);
      if (walker.currentNode.textContent.trim() && parent.offsetParent && size < 12) small.push(`${size} ${walker.currentNode.textContent}`);
    }
    verify(small.length === 0, small.join("; "));
    const unnamed = [...narrow.querySelectorAll("input, select, textarea, iframe, progress")].filter(
      (field) => field.offsetParent && !field.labels?.length && !field.getAttribute("aria-label") && !field.title,
    );
    verify(unnamed.length === 0, unnamed.map(({ outerHTML }) => outerHTML).join("; "));
  },
};

// In a frame of the page to try, the page alone is of interest.
if (window === top) {
  try {
    await until(() => window.page?.answer, "the first arch");
    await PARTS[part]();
  } catch (error) {
    failures.push(`${error} ${error.stack}`);
  }
  failures.push(...window.errors);
  await fetch(address, { method: "POST", mode: "no-cors", body: JSON.stringify({ failures, passed }) });
}
