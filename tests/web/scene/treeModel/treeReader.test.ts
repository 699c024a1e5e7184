/** Trees read by a worker, and by the page where there is none. */
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import {
  answer,
  buffersIn,
  type ReadOrder,
  type ReadReply,
} from "../../../../web/src/scene/treeModel/reading";
import { readTree, type TreeMesh } from "../../../../web/src/scene/treeModel/treeArrays";
import { TreeReader } from "../../../../web/src/scene/treeModel/treeReader";

const KIND = { varied: true, evergreen: false };

/** A stem of two triangles and a leaf card at this height. */
function meshes(height_m: number): TreeMesh[] {
  const quad = (name: string, width_m: number, low_m: number, high_m: number): TreeMesh => ({
    name,
    positions: Float32Array.of(
      ...[-width_m, low_m, 0, width_m, low_m, 0],
      ...[-width_m, high_m, 0, width_m, high_m, 0],
    ),
    normals: Float32Array.from({ length: 12 }, (_, i) => (i % 3 === 2 ? 1 : 0)),
    uvs: null,
    colours: null,
    index: Uint16Array.of(0, 1, 2, 2, 1, 3),
    cutOut: name === "leaves_0",
  });
  return [quad("wood_0", 0.1, 0, height_m), quad("leaves_0", 0.4, height_m, height_m + 1)];
}

/** A worker in this thread: what it is sent and what it sends is copied, as between threads. */
class FakeWorker {
  static made: FakeWorker[] = [];
  onmessage: ((event: { data: ReadReply }) => void) | null = null;
  onerror: (() => void) | null = null;
  readonly orders: ReadOrder[] = [];

  constructor() {
    FakeWorker.made.push(this);
  }

  postMessage(order: ReadOrder): void {
    this.orders.push(structuredClone(order));
  }

  answer(order: ReadOrder): void {
    const reply = answer(order);
    this.onmessage?.({ data: structuredClone(reply, { transfer: [...buffersIn(reply)] }) });
  }
}

const reader = () => new TreeReader(() => new FakeWorker() as unknown as Worker);

beforeEach(() => {
  FakeWorker.made = [];
  vi.stubGlobal("Worker", FakeWorker);
});
afterEach(() => {
  vi.unstubAllGlobals();
});

test("a worker reads what the page would, in any order", async () => {
  const trees = reader();
  const [low, high] = [trees.read(meshes(3), KIND), trees.read(meshes(7), KIND)];
  const [worker] = FakeWorker.made;
  for (const order of [...worker.orders].reverse()) worker.answer(order);
  expect(await low).toEqual(readTree(meshes(3), KIND));
  expect(await high).toEqual(readTree(meshes(7), KIND));
  expect((await high).height_m).toBe(8);
  expect(FakeWorker.made).toHaveLength(1);
});

test("the page reads the trees of a worker that ends, and later ones", async () => {
  const trees = reader();
  const first = trees.read(meshes(4), KIND);
  FakeWorker.made[0].onerror?.();
  expect(await first).toEqual(readTree(meshes(4), KIND));
  expect(await trees.read(meshes(5), KIND)).toEqual(readTree(meshes(5), KIND));
  expect(FakeWorker.made).toHaveLength(1);
});

test("without workers the page reads", async () => {
  vi.stubGlobal("Worker", undefined);
  expect(await reader().read(meshes(4), KIND)).toEqual(readTree(meshes(4), KIND));
});

test("a tree that cannot be read is refused, others are not", async () => {
  const trees = reader();
  const broken = [{ ...meshes(3)[0], index: null as unknown as Uint16Array }];
  const [bad, good] = [trees.read(broken, KIND), trees.read(meshes(3), KIND)];
  const [worker] = FakeWorker.made;
  for (const order of worker.orders) worker.answer(order);
  await expect(bad).rejects.toThrow();
  expect((await good).read).toHaveLength(2);
});

test("every buffer of a message is handed over once", () => {
  const shared = new Float32Array(4);
  const message = { a: shared, b: [{ c: new Uint8Array(shared.buffer), d: null, e: "x" }], f: new Uint32Array(2) };
  expect(buffersIn(message).size).toBe(2);
});
