/** Detection of the graphics capabilities. */

export interface Graphics {
  readonly webgl2: boolean;
  /** Software rasteriser: drawing uses processor time. */
  readonly software: boolean;
}

const SOFTWARE_PATTERN = /swiftshader|llvmpipe|softpipe|software|microsoft basic render/i;

/** Looks at the graphics with the context in which the forest is then drawn, which public/context.js has made. */
export function detectGraphics(view: HTMLCanvasElement): Graphics {
  const gl = view.getContext("webgl2");
  if (!gl) return { webgl2: false, software: false };
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  return { webgl2: true, software: SOFTWARE_PATTERN.test(name) };
}

/** Replaces a canvas by one like it whose context is still to be made, because a context keeps its antialiasing. */
export function renewCanvas(view: HTMLCanvasElement): void {
  const context = view.getContext("webgl2");
  view.replaceWith(view.cloneNode());
  context?.getExtension("WEBGL_lose_context")?.loseContext();
}
