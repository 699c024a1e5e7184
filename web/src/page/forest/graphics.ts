/** Detection of the graphics capabilities. */

export interface Graphics {
  readonly webgl2: boolean;
  /** Software rasteriser: drawing uses processor time. */
  readonly software: boolean;
}

const SOFTWARE_PATTERN = /swiftshader|llvmpipe|softpipe|software|microsoft basic render/i;

/** What a context of its own tells; it is lost afterwards. null: there is none. */
export function graphicsOf(gl: WebGL2RenderingContext | null): Graphics {
  if (!gl) return { webgl2: false, software: false };
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return { webgl2: true, software: SOFTWARE_PATTERN.test(name) };
}

/** In this thread, as browsers need that do not draw in workers. */
const detectHere = () => graphicsOf(document.createElement("canvas").getContext("webgl2"));

/**
 * Detects the graphics, in a worker where that can: the page's own context, made afterwards, then takes milliseconds, because
 * the driver has been started.
 */
export function detectGraphics(): Promise<Graphics> {
  if (typeof OffscreenCanvas === "undefined") return Promise.resolve(detectHere());
  const worker = new Worker(new URL("./graphics.worker.ts", import.meta.url), { type: "module" });
  return new Promise<Graphics>((found) => {
    worker.onmessage = ({ data }: MessageEvent<Graphics>) => found(data.webgl2 ? data : detectHere());
    worker.onerror = () => found(detectHere());
  }).finally(() => worker.terminate());
}
