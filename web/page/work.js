// Workers: the library computes in them, so that the page answers its reader.

const find = (id) => document.getElementById(id);

/** Compiles the module, which is inside this page or beside it. */
async function compile() {
  const inside = find("module");
  return WebAssembly.compile(inside ? await unpack(inside.textContent) : await (await fetch("archrock.wasm")).arrayBuffer());
}

/** Unpacks the module in a worker, so that the page answers in between. */
function unpack(packed) {
  return new Promise((resolve, reject) => {
    const worker = new Worker(workerAddress);
    worker.onerror = () => reject(new Error("workers are refused here"));
    worker.onmessage = ({ data }) => {
      worker.terminate();
      if (data.error) reject(new Error(data.error));
      else resolve(data);
    };
    worker.postMessage(packed);
  });
}

/** Work that takes more seconds begins with its length. */
const LONG_S = 10;

const workerAddress = URL.createObjectURL(new Blob([find("worker").textContent], { type: "text/javascript" }));

/** Says how long work takes that has begun, and how long its rest. */
function estimate(began, done, all) {
  const passed_s = (performance.now() - began) / 1000;
  const all_s = (passed_s * all) / Math.max(done, 1);
  const words = (time_s) => (time_s < 90 ? `${Math.ceil(time_s)} s` : `${Math.ceil(time_s / 60)} min`);
  const whole = all_s > LONG_S ? `this takes some ${words(all_s)}; ` : "";
  return `Computing: ${whole}${Math.floor((100 * done) / all)} %, some ${words(all_s - passed_s)} left`;
}

/** Makes a queue of one request at work and the newest one waiting, with elements that show long work. For a run, `read` receives its scenario before its
 * result; `slow` hears that its first picture takes long, and `stopped` that the reader has stopped it. */
function createQueue(module, [status, bar, stop], { read, slow, stopped } = {}) {
  /** Repetitions have a worker of their own: they may be stopped, and a new worker is slow at first. */
  const workers = new Map();
  const repeats = () => work.request.no_repeat === false;
  let work = null;
  let waiting = null;

  function createWorker() {
    const worker = new Worker(workerAddress);
    worker.onmessage = ({ data }) => {
      if (data.answer) finish(data.answer);
      else if (data.scenario) read?.(data.scenario);
      else show(data);
    };
    worker.onerror = (event) => halt({ errors: [{ message: `the worker failed: ${event.message}` }], files: {} });
    worker.postMessage(module);
    return worker;
  }

  function finish(answer) {
    clearTimeout(work.timer);
    const done = work;
    work = null;
    bar.hidden = stop.hidden = true;
    status.textContent = "";
    done.resolve(answer);
    if (!work && waiting) begin(waiting);
  }

  function begin(next) {
    waiting = null;
    work = next;
    work.began = performance.now();
    if (!workers.has(repeats())) workers.set(repeats(), createWorker());
    workers.get(repeats()).postMessage(work.request);
    work.timer = setTimeout(() => {
      stop.hidden = false;
      status.textContent = "Computing…";
      // While a history is completed or repeated, its picture is the present one.
      if (work.request.sways_only) slow?.();
    }, 400);
  }

  function show({ done, all }) {
    if (!work) return;
    // Some studies have several rounds.
    if (!(done >= work.done)) work.round = performance.now();
    work.done = done;
    if (stop.hidden) return;
    bar.hidden = false;
    bar.value = all > 0 ? done / all : 0;
    const end = work.request.study === "run" ? "Repeating with other steps…" : "Drawing…";
    status.textContent = done >= all ? end : estimate(work.round, done, all);
  }

  /** Ends the work with this answer; `null` means that nobody waits for it. */
  function halt(answer) {
    if (!work) return;
    workers.get(repeats()).terminate();
    workers.delete(repeats());
    finish(answer);
  }

  stop.addEventListener("click", () => {
    halt(null);
    status.textContent = read ? "Stopped. Any change computes again." : "Stopped.";
    stopped?.();
  });

  /** Returns the answer to a request; null if a newer one has replaced it or it was stopped. */
  return function ask(request) {
    return new Promise((resolve) => {
      waiting?.resolve(null);
      waiting = { request, resolve };
      if (!work) begin(waiting);
      // A reader who goes on waits neither for repetitions nor for long work.
      else if (repeats() || performance.now() - work.began > 1000) halt(null);
    });
  };
}
