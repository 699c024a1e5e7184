/** Detection of the graphics capabilities. */

export interface Graphics {
  readonly webgl2: boolean;
  /** Software rasteriser: drawing uses processor time. */
  readonly software: boolean;
}

const SOFTWARE_PATTERN = /swiftshader|llvmpipe|softpipe|software|microsoft basic render/i;

function look(): Graphics {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return { webgl2: false, software: false };
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return { webgl2: true, software: SOFTWARE_PATTERN.test(name) };
}

/** Settled when the driver runs, or cannot be started in a worker. */
function startDriver(): Promise<unknown> {
  if (typeof OffscreenCanvas === "undefined") return Promise.resolve();
  const worker = new Worker(new URL("./graphicsStart.worker.ts", import.meta.url), { type: "module" });
  return new Promise((done) => {
    worker.onmessage = done;
    worker.onerror = done;
  }).finally(() => worker.terminate());
}

/** Detects the graphics, without holding up the page: contexts take milliseconds once the driver has been started. */
export async function detectGraphics(): Promise<Graphics> {
  await startDriver();
  return look();
}
