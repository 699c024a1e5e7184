/** Detection of the graphics: in the page, after a worker has started the driver. */
import { afterEach, expect, test, vi } from "vitest";
import { detectGraphics } from "../../../web/src/page/forest/graphics";

interface Starter {
  onmessage?: () => void;
  onerror?: () => void;
}

/** A browser whose page has a context of this name, and whose worker behaves like this; null: it cannot draw in workers. */
function browser(name: string | null, act: ((worker: Starter) => void) | null) {
  const order: string[] = [];
  const context = name && { RENDERER: 1, getExtension: () => null, getParameter: () => name };
  const getContext = () => {
    order.push("page");
    return context;
  };
  vi.stubGlobal("document", { createElement: () => ({ getContext }) });
  vi.stubGlobal("OffscreenCanvas", act ? class {} : undefined);
  vi.stubGlobal(
    "Worker",
    class implements Starter {
      onmessage?: () => void;
      onerror?: () => void;
      constructor() {
        queueMicrotask(() => {
          order.push("worker");
          act?.(this);
        });
      }
      terminate() {
        order.push("ended");
      }
    },
  );
  return order;
}

afterEach(() => vi.unstubAllGlobals());

test("a software rasteriser is recognised by its name, once the driver runs", async () => {
  const order = browser("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device))", (worker) => worker.onmessage?.());
  expect(await detectGraphics()).toEqual({ webgl2: true, software: true });
  expect(order).toEqual(["worker", "ended", "page"]);
  browser("NVIDIA GeForce", (worker) => worker.onmessage?.());
  expect(await detectGraphics()).toEqual({ webgl2: true, software: false });
});

test("what the page cannot do counts, whatever the worker can", async () => {
  browser(null, (worker) => worker.onmessage?.());
  expect((await detectGraphics()).webgl2).toBe(false);
});

test("a worker that fails or cannot draw does not matter", async () => {
  browser("SwiftShader", (worker) => worker.onerror?.());
  expect((await detectGraphics()).webgl2).toBe(true);
  browser("SwiftShader", null);
  expect((await detectGraphics()).webgl2).toBe(true);
});
