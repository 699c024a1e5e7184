/** Detection of the graphics capabilities. */

export interface Graphics {
  readonly webgl2: boolean;
  /** Software rasteriser: drawing uses processor time. */
  readonly software: boolean;
}

const SOFTWARE_PATTERN = /swiftshader|llvmpipe|softpipe|software|microsoft basic render/i;

/** Looks at the graphics with a context of its own; the first one of a browser takes up to a third of a second. */
export function detectGraphics(): Graphics {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return { webgl2: false, software: false };
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return { webgl2: true, software: SOFTWARE_PATTERN.test(name) };
}
