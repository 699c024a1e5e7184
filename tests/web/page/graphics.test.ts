/** Detection of the graphics. */
import { expect, test } from "vitest";
import { detectGraphics, renewCanvas } from "../../../web/src/page/forest/graphics";

/** A canvas whose context has this name; null: it has none. */
function canvas(name: string | null): HTMLCanvasElement {
  const context = name && { RENDERER: 1, getExtension: () => null, getParameter: () => name };
  return { getContext: () => context } as unknown as HTMLCanvasElement;
}

test("a software rasteriser is recognised by its name", () => {
  const software = canvas("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device))");
  expect(detectGraphics(software)).toEqual({ webgl2: true, software: true });
  expect(detectGraphics(canvas("NVIDIA GeForce"))).toEqual({ webgl2: true, software: false });
});

test("a browser without WebGL 2 is recognised", () => {
  expect(detectGraphics(canvas(null)).webgl2).toBe(false);
});

test("a canvas whose context has to be made anew is replaced by one like it", () => {
  const events: string[] = [];
  const view = {
    getContext: () => ({ getExtension: () => ({ loseContext: () => events.push("lost") }) }),
    cloneNode: () => "copy",
    replaceWith: (node: unknown) => events.push(`replaced by ${node}`),
  };
  renewCanvas(view as unknown as HTMLCanvasElement);
  expect(events).toEqual(["replaced by copy", "lost"]);
});
