/** Detection of the graphics. */
import { afterEach, expect, test, vi } from "vitest";
import { detectGraphics } from "../../../web/src/page/forest/graphics";

/** A browser whose context has this name; null: it has none. */
function browser(name: string | null) {
  const context = name && { RENDERER: 1, getExtension: () => null, getParameter: () => name };
  vi.stubGlobal("document", { createElement: () => ({ getContext: () => context }) });
}

afterEach(() => vi.unstubAllGlobals());

test("a software rasteriser is recognised by its name", () => {
  browser("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device))");
  expect(detectGraphics()).toEqual({ webgl2: true, software: true });
  browser("NVIDIA GeForce");
  expect(detectGraphics()).toEqual({ webgl2: true, software: false });
});

test("a browser without WebGL 2 is recognised", () => {
  browser(null);
  expect(detectGraphics().webgl2).toBe(false);
});
