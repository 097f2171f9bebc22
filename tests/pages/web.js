// Checks of the page to try, in the page itself. `part` chooses them; the verdict goes to the test at `address`.
const failures = [];
let passed = 0;
const verify = (holds, what) => {
  if (holds) passed += 1;
  else failures.push(what);
};
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Waits until something holds, at most two minutes. */
async function until(holds, what) {
  for (const begin = performance.now(); !holds(); await wait(20)) {
    if (performance.now() - begin > 120000) throw new Error(`in vain: ${what}`);
  }
  passed += 1;
}

const element = (id) => document.getElementById(id);
const event = (target, name) => target.dispatchEvent(new Event(name, { bubbles: true }));
const inside = (id) => element(id).querySelector("iframe:not(.waiting)").contentWindow;
const headline = () => element("answer").textContent;
/** All lines of the answer that the page shows. */
const answerShown = () => [headline(), ...[...element("conditions").children].map((line) => line.textContent)];
const linesOf = (answer) => answer.replace(/\n {4,}/g, " ").split("\n").map((line) => line.trim());
/** Returns the text in the address. */
const addressed = () => decodeURIComponent(location.hash.split("&scenario=")[1] ?? "");

/** Drops files on the page, given by their names and contents. */
function drop(...given) {
  const dropped = new DataTransfer();
  for (const [name, contents] of given) dropped.items.add(new File([contents], name));
  document.dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true, cancelable: true }));
}

/** Returns the CRC-32 of a text, by a table. */
function checkSumOf(text) {
  const table = Array.from({ length: 256 }, (_, byte) => [...Array(8)].reduce((sum) => (sum & 1 ? 0xedb88320 ^ (sum >>> 1) : sum >>> 1), byte));
  const sum = new TextEncoder().encode(text).reduce((now, byte) => table[(now ^ byte) & 255] ^ (now >>> 8), -1);
  return ((sum ^ -1) >>> 0).toString(16).padStart(8, "0");
}

/** Presses a key with Ctrl. */
const control = (key, on = document.body) => on.dispatchEvent(new KeyboardEvent("keydown", { key, ctrlKey: true, bubbles: true, cancelable: true }));
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
    }
  },

  async statics() {
    const points = (id) => [...element(id).getAttribute("d").matchAll(/[ML]([-\d.e]+) ([-\d.e]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);
    const said = () => element("held").textContent;
    const push = (value) => {
      element("push").value = value;
      event(element("push"), "input");
    };
    const press = (id, key, times = 1) => {
      for (let i = 0; i < times; i += 1) element(id).dispatchEvent(new KeyboardEvent("keydown", { key }));
    };
    element("statics").open = true;
    await until(() => !element("touch").hidden, "the first arch in hand");
    for (const { scenario, starts_g } of data) {
      element("held").textContent = "";
      await afterwards(() => page.edit(scenario), "an arch");
      await until(said, "its statics");
      const [right, left] = [Number(element("push").max), -Number(element("push").min)];
      const is = (one, other) => Math.abs(one - other) < 1e-6 * other;
      verify(is(right, starts_g[0]) && is(left, starts_g[1]), `first motions ${right}, ${left}: ${starts_g}; ${scenario}`);
      const width = element("at-rest").viewBox.baseVal.width;
      for (const end of [-left, right]) {
        for (const part of [0, 0.5, 0.999]) {
          push(part * end);
          verify(/^This reaction holds/.test(said()) && points("held-region").length > 2, `${part} of ${end}: ${said()} ${scenario}`);
        }
        push(end);
        const line = points("thrust-line");
        const hinges = points("opened");
        const far = hinges.map(([x, y]) => Math.min(...line.map((point) => Math.hypot(point[0] - x, point[1] - y))) / width);
        verify(hinges.length >= 3 && Math.max(...far) < 1e-6, `the line is ${far} from hinges: ${scenario}`);
        verify(/one reaction is left/.test(said()) && points("moved").length > 10, said());
        // Beyond it, all along the springing: a step of a handle is 0.5 % of the picture.
        Object.assign(element("push"), { min: -2 * left, max: 2 * right });
        push(1.002 * end);
        press("foot", "ArrowLeft", 60);
        press("foot", "ArrowDown", 60);
        let left_over = 0;
        for (let step = 0; step < 60; step += 1) {
          left_over += points("held-region").length;
          press("foot", "ArrowRight");
        }
        verify(left_over === 0 && /no reaction holds it/.test(said()), `${said()} ${scenario}`);
      }
      push(0);
      // A reaction that is pulled away holds no more; a press of the button finds one again.
      press("tail", "ArrowLeft", 40);
      verify(/does not hold.*leaves the stone at joint/.test(said()), said());
      element("hold").click();
      verify(/^This reaction holds/.test(said()), said());
    }
    await afterwards(() => page.edit("[column]\nheight_m = 4.0\nwidth_m = 0.6\n[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.3\n"), "a column");
    await until(() => /must be an arch of voussoirs/.test(said()) && element("touch").hidden, "a column has no statics to touch");
  },

  async readers() {
    const text = element("text");
    const slider = (key) => element(`number-${key}`);
    const four = data.start.replace("-0.35", "-0.3");
    await afterwards(() => page.edit(four), "four links");
    // Sliders change the text, and the text moves the sliders.
    await afterwards(() => {
      const number = slider("ground.half_sine.amplitude_g");
      number.nextSibling.value = -0.35;
      event(number.nextSibling, "input");
    }, "a slider");
    verify(text.value.includes("amplitude_g = -0.35\n"), text.value);
    verify(firstLine(page.answer.words) === firstLine(data.slider), `${page.answer.words}\n${data.slider}`);
    verify(answerShown().join("\n") === linesOf(data.answer).join("\n"), `${answerShown().join("\n")}\n${data.answer}`);
    await until(() => addressed() === text.value, "the address");
    verify([...document.querySelectorAll(".slider")].filter((row) => row.offsetParent).length === 6, "sliders of the arch and its pulse");
    const tasks = [];
    new PerformanceObserver((list) => list.getEntries().forEach(({ duration }) => tasks.push(duration))).observe({ type: "longtask" });
    await afterwards(() => page.edit(text.value.replace("-0.35", "-0.36")), "a text");
    verify(slider("ground.half_sine.amplitude_g").value === "-0.36", "the slider follows the text");
    // The view of the reader stays.
    const box = element("sizes");
    box.click();
    await afterwards(() => page.edit(text.value.replace("-0.36", "-0.35")), "the view");
    verify(element("sizes").checked === false, "dimensions stay hidden");
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
    verify(element("stage") !== null && headline().startsWith("No verdict"), "the last picture, without its verdict");
    element("errors").querySelector("button").click();
    verify(text.selectionStart > 0 && document.activeElement === text, "the cursor is at the error");
    await page.edit("[arch");
    verify(element("errors").textContent.includes("not valid TOML"), element("errors").textContent);
    await afterwards(() => page.edit(good), "a mended text");
    verify(element("errors").children.length === 0, element("errors").textContent);

    // Records.
    await afterwards(() => page.edit(good.replace(/\n\[free_hinges\][^[]*/, "\n")), "four links");
    await afterwards(() => drop(["synthetic.at2", data.record]), "a record");
    verify(page.answer.words === data.of_record, `${page.answer.words}\n${data.of_record}`);
    drop(["large.at2", new Uint8Array(50e6)]);
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
    verify(element("notes").querySelector(".warning").textContent.includes("is its unit"), "the unit is doubted");

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

  /** No verdict before it is certain, no scenario that is another one than it seems, no change without a way back. */
  async truth() {
    const text = element("text");
    const start = text.value;
    const stays = async (act, what) => {
      const now = text.value;
      act();
      await until(() => element("errors").textContent.includes("is refused"), what);
      verify(text.value === now && page.answer !== null, `${what}: ${text.value}`);
      element("errors").replaceChildren();
    };

    // The first history of a row of blocks is none to quote, in the headline or below it.
    await until(() => page.answer?.words.includes("repeated (") && headline().startsWith("SURVIVES"), `an answer: ${headline()}`);
    const headlines = [];
    new MutationObserver(() => headlines.push(headline())).observe(element("answer"), { childList: true });
    await afterwards(() => page.edit(start.replace("-0.35", "-0.45")), "a pulse that overturns");
    verify(answerShown().join(" ").startsWith("Not repeated yet: no verdict. This is one history."), headline());
    verify(getComputedStyle(element("told")).display === "none" && !/overturns|survives/i.test(element("view").textContent + element("conditions").textContent), "words of the first history");
    // The first sways come first, then the whole history.
    const sways = page.answer;
    await until(() => page.answer !== sways, "the whole history");
    verify(page.answer.files["report.html"].length > sways.files["report.html"].length || page.answer.words.includes("overturned"), "the whole history is longer");
    await until(() => headline().startsWith("OVERTURNS"), headline());
    verify(headlines.filter((one) => !one.startsWith("Not computed")).join("; ") === `Not repeated yet: no verdict.; ${headline()}`, headlines.join("; "));
    verify(getComputedStyle(element("told")).display !== "none", "words of all histories");
    // None after Stop.
    const slow = page.edit(start.replace("-0.35", "-0.36").replace("voussoirs = 36", "voussoirs = 160"));
    await until(() => !element("stop").hidden, "long work");
    verify(headline() === "Not computed yet: no verdict." && document.body.classList.contains("stale"), headline());
    element("stop").click();
    verify(headline() === "Stopped before the repetitions: no verdict.", headline());
    await slow;
    verify(headline() === "Stopped before the repetitions: no verdict.", headline());
    // None where nothing moves.
    await page.edit(start.slice(0, start.indexOf("[ground")));
    verify(headline().startsWith("No verdict") && element("status").textContent.includes("nothing moves the structure: give a table [ground.<kind>]"), element("status").textContent);

    // A link has a check sum.
    await afterwards(() => page.edit(`${start}# ü α % \u{1f3db}\n`), "letters of all kinds");
    const link = location.hash;
    verify(/^#check=[0-9a-f]{8}&scenario=/.test(link) && addressed() === text.value, link);
    verify(checkSumOf("123456789") === "cbf43926" && link.startsWith(`#check=${checkSumOf(text.value)}`), link);
    await afterwards(() => page.edit(start), "the first arch");
    verify(location.hash === "" && location.pathname.length > 1 === location.protocol.startsWith("file"), location.href);
    for (const wrong of [link.slice(0, -1), link.slice(0, -4), link.slice(0, 40), link.slice(0, 4), link.replace("0.35", "0.36"), link.replace("arch", "arcs"), "#%E0%A4%A"]) {
      await afterwards(() => (location.hash = wrong), wrong);
      verify(element("broken").textContent.includes("damaged") && !element("broken").hidden && text.value === start, `${wrong}: ${element("broken").textContent}`);
    }
    await afterwards(() => (location.hash = link), "the whole link");
    verify(element("broken").hidden && text.value.includes("ü α % \u{1f3db}"), element("broken").textContent);
    const old = data.start;
    await afterwards(() => (location.hash = encodeURIComponent(old)), "an older link");
    verify(text.value === old && element("broken").textContent.includes("older link, not checked"), element("broken").textContent);
    await afterwards(() => history.back(), "Back from a link");
    verify(text.value.includes("ü") && element("broken").hidden, text.value);

    // A wrong file changes nothing; a right one leaves the pulse, which returns.
    const pulse = `${data.start.slice(0, data.start.indexOf("[ground"))}[ground.ricker]\namplitude_g = -0.417 # calibrated\nduration_s = 0.93\n`;
    await afterwards(() => page.edit(pulse), "a pulse");
    await stays(() => drop(["photo.txt", "no numbers"]), "a text");
    await stays(() => drop(["photo.at2", "no record"]), "a wrong record");
    await stays(() => drop(["image.at2", "a\u0000b"]), "an image");
    await stays(() => drop(["wrong.toml", "[arch\n"]), "a wrong scenario");
    verify(element("files").textContent === "", element("files").textContent);
    await afterwards(() => drop(["synthetic.at2", data.record]), "a record");
    verify(text.value.includes('[ground.record]\nfile = "synthetic.at2"') && !text.value.includes("ricker"), text.value);
    await choose("ground", "ricker");
    verify(text.value === pulse, text.value);
    await choose("ground", "record:synthetic.at2");
    await afterwards(() => page.edit(text.value.replace("scale = 1.0", "scale = 1.5")), "a factor");
    await choose("ground", "ricker");
    await choose("ground", "record:synthetic.at2");
    verify(text.value.includes("scale = 1.5"), text.value);
    verify(element("ground").value === "record:synthetic.at2" && text.value.includes('file = "synthetic.at2"'), text.value);
    await afterwards(() => history.back(), "Back from a record");
    verify(text.value === pulse, text.value);
    await stays(() => drop(["synthetic.at2", "another, which is no record"]), "a wrong record of the same name");
    // A table of errors goes with the next choice.
    await page.edit(pulse.replace("ricker", "riker"));
    await choose("ground", "rectangular");
    verify((text.value.match(/\[ground/g) ?? []).length === 1 && element("errors").children.length === 0, text.value);
    // Several records are listed, and taken together.
    await afterwards(() => drop(["one.csv", "0,0\n0.1,1\n0.2,-1\n0.3,0\n"], ["two.at2", data.record]), "two records");
    verify(["one.csv", "two.at2", "synthetic.at2"].every((name) => element("files").textContent.includes(name)), element("files").textContent);
    verify(["record:one.csv", "record:two.at2"].every((name) => [...element("ground").options].some(({ value }) => value === name)), element("ground").textContent);
    // A scenario opens.
    await afterwards(() => drop(["scenario.toml", pulse]), "a scenario");
    verify(text.value === pulse, text.value);

    // Undo, by keys, the button and Back, for every kind of change; Reset.
    await afterwards(() => page.edit(start), "the first arch");
    const range = element("number-ground.half_sine.amplitude_g").nextSibling;
    const slide = (...values) => values.forEach((value) => {
      range.value = value;
      event(range, "input");
    });
    await afterwards(() => slide(-0.3, -0.31, -0.32), "a slider");
    await until(() => addressed().includes("-0.32"), "its address");
    await afterwards(() => control("z"), "Ctrl+Z");
    verify(text.value === start && range.value === "-0.35", text.value);
    await afterwards(() => control("y"), "Ctrl+Y");
    verify(text.value.includes("-0.32"), text.value);
    text.value = start.replace("180", "175");
    event(text, "input");
    await until(() => page.answer.scenario.arch.embrace_deg === 175, "typed text");
    await afterwards(() => control("z", text), "Ctrl+Z in the text");
    verify(text.value.includes("-0.32") && text.value.includes("180"), text.value);
    await choose("structure", "column");
    await afterwards(() => element("undo").click(), "Undo");
    verify(text.value.includes("-0.32") && element("structure").value === "arch", text.value);
    await afterwards(() => element("reset").click(), "Reset");
    verify(text.value === start, text.value);
    await afterwards(() => element("reset").click(), "Reset again, which is no step");
    await afterwards(() => history.back(), "Back from Reset");
    verify(text.value.includes("-0.32"), text.value);

    // Quoted keys, blanks in headers, strings and arrays of several lines.
    const forms = `title = """\n[arch]\nmean_radius_m = 1\n"""\n["arch"]\n"mean_radius_m" = 5.0 # metres\nthickness_ratio = 0.15\nembrace_deg = 180\nvoussoirs = 20\n[ ground . half_sine ]\namplitude_g = -0.3\n'duration_s' = 0.3\n[map]\nduration_s = [\n  0.1,\n  0.2\n]\namplitude_g = [0.1, 0.2]\n`;
    await afterwards(() => page.edit(forms), `forms ${element("status").textContent}`);
    const set = (key, value) => afterwards(() => {
      element(`number-${key}`).value = value;
      event(element(`number-${key}`), "input");
    }, key);
    await set("arch.mean_radius_m", 6);
    await set("ground.half_sine.duration_s", 0.4);
    verify(text.value === forms.replace("= 5.0", "= 6").replace("'duration_s' = 0.3", "'duration_s' = 0.4"), text.value);
    await choose("ground", "one_sine");
    await choose("structure", "column");
    verify(text.value.startsWith('title = """\n[arch]\nmean_radius_m = 1\n"""\n[column]') && text.value.includes("[ ground . one_sine ]") && text.value.includes("duration_s = [\n  0.1,"), text.value);
    verify(element("errors").children.length === 0, element("errors").textContent);
  },

  /** What a reader meets first. */
  async sight() {
    const text = element("text");
    const { archrock } = window;
    verify(page.answer.scenario.free_hinges !== undefined, "free hinges");
    await until(() => window.archrock.shown().playing && window.archrock.shown().time < 0.5, "the arch moves by itself, from the start");
    const words = [];
    const { fillText } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.fillText = function (said, ...rest) {
      words.push(said);
      return fillText.call(this, said, ...rest);
    };
    window.archrock.seek(0.7);
    const times = element("exaggeration").value;
    verify(times > 1 && words.includes(`movement drawn ${times} times as large`), words.join("; "));
    element("play").click();
    element("play").click();
    verify(archrock !== undefined && /^[SPN]/.test(headline()), headline());

    // Help at each control.
    const silent = [...document.querySelectorAll("#form :is(input, select)")].filter((field) => !(field.ariaDescription ?? field.title) && !field.getAttribute("aria-describedby"));
    verify(silent.length === 0, silent.map(({ id, outerHTML }) => id || outerHTML).join("; "));

    // Six questions of one click, with a sentence and a document.
    const cards = [...element("questions").children];
    verify(cards.map((card) => card.querySelector("button").textContent).join("; ") ===
      "Which push fells it?; Stronger, yet it survives; Twice as large; Four hinges or all joints?; On piers; Your record", "the questions");
    verify(cards.every((card) => card.querySelector("p").textContent.length > 40 && data.documents.includes(card.textContent.match(/docs\/(\w+)\.md/)?.[1])), "sentences and documents");
    const ask = async (number, begins) => {
      cards[number].querySelector("button").click();
      await until(() => headline().startsWith("Not repeated") || page.answer === null, `question ${number}`);
      await until(() => headline().startsWith(begins), `the answer to question ${number}: ${headline()}`);
      verify(element("errors").children.length === 0, element("errors").textContent);
    };
    const compared = () => [...element("plots").querySelectorAll(".plot")].find((plot) => plot.textContent.includes("now and before"))?.textContent ?? "";
    await ask(1, "SURVIVES");
    verify(text.value.includes("0.6\n") && compared().includes("amplitude_g = 0.47"), compared());
    await ask(2, "SURVIVES");
    verify(compared().includes("mean_radius_m = 10") && compared().includes("mean_radius_m = 5"), compared());
    await ask(3, "SURVIVES");
    verify(compared().includes("free hinges") && compared().includes("four links"), compared());
    await ask(4, "OVERTURNS");
    verify(compared() === "" && text.value.includes("[piers]"), compared());
    let asked = false;
    element("record").addEventListener("click", (click) => (click.preventDefault(), (asked = true)), { once: true });
    cards[5].querySelector("button").click();
    verify(asked, "a file is asked for");
    // The first one ends with a threshold, which is marked beside the slider, for this scenario alone.
    cards[0].querySelector("button").click();
    await until(() => page.study?.files["threshold.csv"], `the threshold: ${element("study-status").textContent}`);
    const mark = () => [...document.querySelectorAll(".slider .mark")].find((one) => one.offsetParent)?.textContent ?? "";
    await until(() => mark() !== "", "a mark");
    verify(/^▲ -0\.387 overturns$/.test(mark()), mark());
    const place = () => [...document.querySelectorAll(".slider .mark")].find((one) => one.offsetParent).getBoundingClientRect();
    const inForm = ({ left, right }) => left >= 0 && right <= element("form").getBoundingClientRect().right;
    verify(inForm(place()), "the mark is in the form");
    await afterwards(() => page.edit(text.value.replace("-0.39", "-0.2")), "another amplitude");
    verify(mark().includes("-0.387"), mark());
    // Every file of the study, and the picture, can be saved.
    const saved = [];
    const { click } = HTMLAnchorElement.prototype;
    HTMLAnchorElement.prototype.click = function () {
      saved.push(this.download);
    };
    element("study-files").querySelectorAll("button").forEach((button) => button.click());
    document.querySelector("[data-save='arch.png']").click();
    await until(() => saved.includes("arch.png"), "the picture");
    verify(["threshold.html", "threshold.csv", "threshold.svg", "threshold.json"].every((name) => saved.includes(name)), saved.join());
    HTMLAnchorElement.prototype.click = click;
    await afterwards(() => page.edit(text.value.replace("5.0", "6.0")), "another arch");
    verify(mark() === "", mark());

    // Examples of the recipes.
    const examples = [...element("example").options];
    verify(examples.length > 8, "examples");
    const example = (title) => examples.find(({ textContent }) => textContent === title).value;
    await choose("example", example("Arch of 6 m span and 2 m rise"));
    verify(text.value.includes("Arch of 6 m span") && text.value.includes("-0.8"), text.value);
    await choose("example", example("Column under cosine pulses"));
    await until(() => page.study?.files["map.csv"] || element("study-status").textContent.includes("valid"), "a map");
    verify(page.study.files["map.csv"]?.startsWith("duration_s,amplitude_g"), `${Object.keys(page.study.files).join()} ${element("study-status").textContent}`);
    await choose("example", example("Arch of 6 m span and 2 m rise"));

    // A fall is drawn as large as it is.
    await afterwards(() => page.edit(`${text.value}# again\n`), "the fall again");
    await until(() => headline().startsWith("OVERTURNS"), headline());
    verify(element("exaggeration").value === "1", `drawn ${element("exaggeration").value} times as large`);

    // Each first choice moves.
    await afterwards(() => element("reset").click(), "Reset");
    const lifeless = [];
    for (const model of ["", "free_hinges"]) {
      for (const structure of ["arch", "pointed_arch", "elliptic_arch", "column"]) {
        await choose("model", model);
        await choose("structure", structure);
        for (const pulse of ["rectangular", "step_pair", "half_sine", "one_sine", "one_cosine", "triangular", "ricker", "antisymmetric_ricker", "mavroeidis_papageorgiou", "gabor", "windowed_sine"]) {
          await choose("ground", pulse);
          const most = Math.max(...window.archrock.largest()[1].map(Math.abs));
          if (!(most > 2e-4) || element("errors").children.length > 0) lifeless.push(`${model} ${structure} ${pulse} ${most}`);
        }
      }
    }
    verify(lifeless.length === 0, lifeless.join("; "));
  },

  /** Hosts that refuse something, and a page that connects to nothing. */
  async hosts() {
    const refused = [];
    document.addEventListener("securitypolicyviolation", ({ effectiveDirective }) => refused.push(effectiveDirective));
    const fails = (promise) => promise.then(() => false, () => true);
    verify(await fails(fetch(`${address}secret`, { method: "POST", mode: "no-cors", body: "text" })), "a connection");
    navigator.sendBeacon(`${address}secret`, "text");
    const image = new Image();
    verify(await fails(new Promise((resolve, reject) => Object.assign(image, { onload: resolve, onerror: reject, src: `${address}secret.png` }))), "a picture");
    await until(() => refused.filter((one) => one === "connect-src").length === 2 && refused.includes("img-src"), `the policy: ${refused.join()}`);
    const policy = document.querySelector("meta[http-equiv=Content-Security-Policy]").content;
    verify(policy.startsWith("default-src 'none'") && !/https:|\*/.test(policy), policy);

    // A host that takes the page into a frame of its own.
    const whole = await (await fetch(`${address}single`)).text();
    const told = (html) => html.replace(/<\/body>(?![^]*<\/body>)/, `<script>setInterval(() => parent.postMessage(["answer", "broken", "study-status"].map((id) => document.getElementById(id)?.textContent), "*"), 200); window.study = () => page.computeStudy("limit");<\/script></body>`);
    const host = async (html, sandbox, holds, what) => {
      const frame = document.createElement("iframe");
      if (sandbox) frame.sandbox = sandbox;
      let last = null;
      const hear = ({ source, data: said }) => {
        if (source === frame.contentWindow) last = said;
      };
      addEventListener("message", hear);
      Object.assign(frame, { srcdoc: html, width: 900, height: 700 });
      document.body.append(frame);
      await until(() => last && holds(last, frame), `${what}: ${last}`);
      removeEventListener("message", hear);
      frame.remove();
    };
    // There, a change and a study.
    const four = "page.edit(document.getElementById('text').value.replace('[free_hinges]', ''))";
    const used = told(whole).replace("setInterval(", `let done; setInterval(() => window.page?.answer && !done && (done = true) && (${four}, window.study()), 100); setInterval(`);
    await host(used, "allow-scripts", ([answer, , study]) => /four links/.test(answer) && study.includes("refuses frames"), "a sandbox");
    const withPolicy = (words) => told(whole).replace("<head>", `<head><meta http-equiv="Content-Security-Policy" content="${words}">`);
    await host(withPolicy("script-src 'unsafe-inline' blob:"), "", ([, broken]) => broken.includes("refuses WebAssembly"), "no WebAssembly");
    await host(withPolicy("worker-src 'none'"), "", ([, broken]) => broken.includes("workers are refused"), "no workers");
    // Without scripts the page says so by itself: at once where the browser has none, after some seconds where the host forbids them.
    const bare = Object.assign(document.createElement("iframe"), { srcdoc: whole.replace("<head>", `<head><meta http-equiv="Content-Security-Policy" content="script-src 'none'">`) });
    document.body.append(bare);
    await until(() => bare.contentDocument?.getElementById("refused"), "a page without scripts");
    const seen = () => bare.contentWindow.getComputedStyle(bare.contentDocument.getElementById("refused")).visibility;
    verify(seen() === "hidden", "the sentence comes too early");
    await until(() => seen() === "visible", "a sentence without scripts");
    verify(/refuses the scripts/.test(bare.contentDocument.getElementById("refused").textContent) && element("refused") === null, "the sentence");
    verify(/needs JavaScript/.test(document.querySelector("noscript").textContent), "noscript");
    bare.remove();

    // Tables scroll by keys.
    await afterwards(() => page.edit(element("text").value.replace("[free_hinges]\n", "")), "four links");
    await page.computeStudy("threshold");
    const tables = [...inside("study-page").document.querySelectorAll(".scroll")];
    verify(tables.length > 0 && tables.every(({ tabIndex }) => tabIndex === 0), "tables that scroll");
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
    // Whatever the reader moves, the stage stays in view, also at 200 %.
    for (const [width, height] of [[390, 840], [768, 1024], [640, 500], [1280, 900]]) {
      Object.assign(frame, { width, height });
      await wait(300);
      for (const id of ["view", "questions", "number-arch.mean_radius_m", "number-ground.half_sine.duration_s", "model"]) {
        narrow.getElementById(id).scrollIntoView({ block: "end" });
        await wait(50);
        const { top, bottom } = narrow.getElementById("stage").getBoundingClientRect();
        verify(top >= 0 && bottom <= height && bottom - top >= 150, `${width}: the stage from ${top} to ${bottom} at ${id}`);
      }
      verify(narrow.documentElement.scrollWidth <= width, `${narrow.documentElement.scrollWidth} px wide of ${width}`);
    }
    Object.assign(frame, { width: 390, height: 840 });
    narrow.getElementById("statics").open = true;
    await until(() => !narrow.getElementById("touch").hidden, "narrow statics");
    await wait(300);
    verify(narrow.documentElement.scrollWidth <= 390, `statics are ${narrow.documentElement.scrollWidth} px wide`);
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
  await fetch(`${address}verdict`, { method: "POST", mode: "no-cors", body: JSON.stringify({ failures, passed }) });
}
