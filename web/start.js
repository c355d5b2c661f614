// Loads the program and starts it, and says what to do where it cannot run or has stopped.

const PACKED = @packed@;
const element = (id) => document.getElementById(id);
const canvas = element("motionscope");

/** Covers the page with the reason why it does not go on. The first one counts: others follow from it. */
function stop(reason, details = "") {
  if (!element("stopped").hidden) return;
  element("reason").textContent = reason;
  element("details").textContent = details;
  element("loading").hidden = true;
  element("stopped").hidden = false;
  element("reload").focus();
}

/** Where the program traps without a panic, no memory was left. */
function stopAfter(error) {
  if (canvas.dataset.panic || !(error instanceof WebAssembly.RuntimeError || error instanceof RangeError)) return;
  stop("Motionscope has stopped because the memory of this page is exhausted. Reload the page to go on, and open a smaller clip.", String(error));
}

/** Reads what the program writes at its canvas: what it shows, why it cannot draw, or the message of a panic. */
function read() {
  const { panic, refused, shown } = canvas.dataset;
  if (panic) stop("Motionscope has stopped because of a fault of its own. Reload the page to go on.", panic);
  else if (refused) stop("Motionscope cannot draw in this browser. Update it, or turn on hardware acceleration in its settings.", refused);
  else if (shown && !element("loading").hidden) {
    performance.mark("shown");
    element("loading").hidden = true;
  }
}

function hasWebGl() {
  return Boolean(navigator.gpu || document.createElement("canvas").getContext("webgl2"));
}

/** The program while it arrives, unpacked; the bar shows how far that is. */
async function download() {
  const response = await fetch("motionscope-@hash@.bin");
  if (!response.ok || !response.body) throw new Error(`the server answers ${response.status}`);
  let received = 0;
  const count = new TransformStream({
    transform(chunk, controller) {
      received += chunk.byteLength;
      element("progress").value = received;
      element("received").textContent = `${megabytes(received)} of ${megabytes(PACKED)} MB`;
      controller.enqueue(chunk);
    },
    flush() {
      performance.mark("downloaded");
    },
  });
  const program = response.body.pipeThrough(count).pipeThrough(new DecompressionStream("gzip"));
  return new Response(program, { headers: { "Content-Type": "application/wasm" } });
}

function megabytes(bytes) {
  return (bytes / 1e6).toFixed(1);
}

async function start() {
  if (!hasWebGl()) {
    stop("Motionscope draws with WebGL 2, which this browser does not offer. Update the browser, or turn on hardware acceleration in its settings.");
    return;
  }
  try {
    const [program, response] = await Promise.all([import("./motionscope-@hash@.js"), download()]);
    await program.default({ module_or_path: response });
  } catch (error) {
    stopAfter(error);
    stop("Motionscope could not be loaded. Check the connection, then reload the page.", String(error));
  }
}

addEventListener("error", (event) => stopAfter(event.error));
addEventListener("unhandledrejection", (event) => stopAfter(event.reason));
element("reload").addEventListener("click", () => location.reload());
canvas.addEventListener("webglcontextlost", () => {
  stop("The browser has taken the graphics card away from this page. Reload the page to go on.");
});
new MutationObserver(read).observe(canvas, { attributeFilter: ["data-shown", "data-panic", "data-refused"] });

start();
if ("serviceWorker" in navigator && isSecureContext) {
  addEventListener("load", () => navigator.serviceWorker.register("service-worker.js", { updateViaCache: "none" }).catch(() => {}));
}
