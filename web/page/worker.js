// Computes in the background: a request in, an answer out, and the progress in between.
let module;
let exports;

function start() {
  const env = { progress: report };
  exports = new WebAssembly.Instance(module, { env }).exports;
}

let told = 0;
function report(done, all) {
  const now = performance.now();
  if (now - told < 100 && done < all) return;
  told = now;
  postMessage({ done, all });
}

const bytes = (place, length) => new Uint8Array(exports.memory.buffer, place, length);

async function unpack(packed) {
  // Without `fetch`: the page forbids every connection.
  const body = new Blob([Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0))]).stream();
  const bytes = await new Response(body.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  postMessage(bytes, [bytes]);
}

onmessage = ({ data }) => {
  if (typeof data === "string") {
    unpack(data).catch((error) => postMessage({ error: error.message }));
    return;
  }
  if (data instanceof WebAssembly.Module) {
    module = data;
    start();
    return;
  }
  told = performance.now();
  // The scenario at once, for the controls; its history takes longer.
  const { scenario } = data.sways_only ? answerTo({ ...data, study: null }) : {};
  if (scenario) postMessage({ scenario });
  postMessage({ answer: answerTo(data) });
};

function answerTo(data) {
  const request = new TextEncoder().encode(JSON.stringify(data));
  const answer = () => JSON.parse(new TextDecoder().decode(bytes(exports.answer(), exports.length())));
  try {
    const place = exports.room(request.length);
    bytes(place, request.length).set(request);
    exports.compute();
    return answer();
  } catch (error) {
    // A panic has left its message; without one the memory was not enough. Both end the module.
    const left = exports.length() > 0 ? answer() : { errors: [{ message: `the computation failed: ${error.message}` }], files: {} };
    start();
    return left;
  }
}
