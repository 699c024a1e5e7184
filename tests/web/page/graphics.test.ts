/** Detection of the graphics: in a worker, or in the page where a worker cannot. */
import { afterEach, expect, test, vi } from "vitest";
import { detectGraphics, graphicsOf } from "../../../web/src/page/forest/graphics";

const contextNamed = (name: string) =>
  ({
    RENDERER: 1,
    getExtension: () => null,
    getParameter: () => name,
  }) as unknown as WebGL2RenderingContext;

/** A page whose own context has this name, and whose worker answers so. */
function browser(answer: ((worker: { onmessage?(event: unknown): void; onerror?(): void }) => void) | null) {
  const ended = vi.fn();
  vi.stubGlobal("document", { createElement: () => ({ getContext: () => contextNamed("SwiftShader") }) });
  vi.stubGlobal("OffscreenCanvas", answer && class {});
  vi.stubGlobal(
    "Worker",
    class {
      onmessage?: (event: unknown) => void;
      onerror?: () => void;
      terminate = ended;
      constructor() {
        queueMicrotask(() => answer?.(this));
      }
    },
  );
  if (!answer) vi.stubGlobal("OffscreenCanvas", undefined);
  return ended;
}

afterEach(() => vi.unstubAllGlobals());

test("a software rasteriser is recognised by its name", () => {
  expect(graphicsOf(contextNamed("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device))")).software).toBe(true);
  expect(graphicsOf(contextNamed("NVIDIA GeForce")).software).toBe(false);
  expect(graphicsOf(null)).toEqual({ webgl2: false, software: false });
});

test("the worker's answer counts, and the worker is ended", async () => {
  const ended = browser((worker) => worker.onmessage?.({ data: { webgl2: true, software: false } }));
  expect(await detectGraphics()).toEqual({ webgl2: true, software: false });
  expect(ended).toHaveBeenCalledOnce();
});

test("a worker that fails, draws nothing or cannot draw leaves it to the page", async () => {
  const here = { webgl2: true, software: true };
  browser((worker) => worker.onerror?.());
  expect(await detectGraphics()).toEqual(here);
  browser((worker) => worker.onmessage?.({ data: { webgl2: false, software: false } }));
  expect(await detectGraphics()).toEqual(here);
  browser(null);
  expect(await detectGraphics()).toEqual(here);
});
