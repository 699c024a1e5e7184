/** Loading of trees, meshes and tables, also out of order. */
import { afterEach, expect, test, vi } from "vitest";
import type { Tree } from "../../web/src/page/server/api";
import { Catalogue } from "../../web/src/page/server/catalogue";
import type { TableMotion } from "../../web/src/worker/protocol";

const model = vi.hoisted(() => ({ parts: [{ vertices: 3 }] }));
const handlers = vi.hoisted(() => ({ change: (_: unknown) => {} }));
vi.mock("../../web/src/scene/trees/mesh/treeMesh", () => ({ readTreeModel: async () => model }));
vi.mock("../../web/src/page/server/api", () => ({
  fetchMesh: async () => new ArrayBuffer(0),
  followEvents: (given: typeof handlers) => {
    handlers.change = given.change;
    return () => {};
  },
  Problem: class extends Error {},
}));

const tree = (table: string | null): Tree =>
  ({ id: "ash", species: "ash", state: "ready", mesh_sha256: "m", table_sha256: table }) as Tree;
const recorded = (table: string, records: string | null): Tree => ({ ...tree(table), records_sha256: records });
const motionOf = (sha256: string, vertices = 3) =>
  ({ sha256, vertexNode: new Uint16Array(vertices) }) as unknown as TableMotion;

/** A catalogue whose tables are delivered by the test. */
function started() {
  const arriving = new Map<string, { resolve(motion: TableMotion): void; reject(error: Error): void }>();
  const grown: (string | null)[] = [];
  const problems: string[] = [];
  const records = { count: 0 };
  const catalogue: Catalogue = new Catalogue(
    (sha256) => new Promise((resolve, reject) => arriving.set(sha256, { resolve, reject })),
    {
      change: () => {},
      assetsChanged: () => grown.push(catalogue.assets[0]?.motion?.sha256 ?? null),
      recordsChanged: () => {
        records.count++;
      },
      connected: () => {},
      problem: (title) => problems.push(title),
    },
  );
  const settle = () => new Promise((done) => setTimeout(done));
  return { arriving, grown, problems, records, settle, catalogue };
}

afterEach(() => vi.clearAllMocks());

test("a tree is static until its table is loaded, and is placed only once if both are loading", async () => {
  const { arriving, grown, settle } = started();
  handlers.change({ tree: tree(null), job: null });
  await settle();
  handlers.change({ tree: tree("full"), job: null });
  arriving.get("full")?.resolve(motionOf("full"));
  await settle();
  expect(grown).toEqual([null, "full"]);
});

test("a full table replaces a preliminary one, even if that one arrives later", async () => {
  const { arriving, grown, settle, catalogue } = started();
  handlers.change({ tree: tree("early"), job: null });
  handlers.change({ tree: tree("full"), job: null });
  arriving.get("full")?.resolve(motionOf("full"));
  await settle();
  arriving.get("early")?.resolve(motionOf("early"));
  await settle();
  expect(grown.at(-1)).toBe("full");
  expect(catalogue.assets[0].motion?.sha256).toBe("full");
});

test("a failed load is reported for a current table but not for a superseded one", async () => {
  const { arriving, problems, settle } = started();
  handlers.change({ tree: tree("early"), job: null });
  handlers.change({ tree: tree("full"), job: null });
  arriving.get("early")?.reject(new Error("404"));
  await settle();
  expect(problems).toEqual([]);
  arriving.get("full")?.reject(new Error("unreadable"));
  await settle();
  expect(problems).toHaveLength(1);
});

test("a table of another mesh is not used", async () => {
  const { arriving, settle, catalogue } = started();
  handlers.change({ tree: tree("other"), job: null });
  arriving.get("other")?.resolve(motionOf("other", 7));
  await settle();
  expect(catalogue.assets[0].motion).toBeNull();
});

test("new records of a tree are announced once, with the state of its job", async () => {
  const { records, settle, catalogue } = started();
  handlers.change({ tree: tree("full"), job: { state: "running", stage: "records", fraction: 0.4 } });
  handlers.change({ tree: recorded("full", null), job: null });
  await settle();
  expect(records.count).toBe(0);
  handlers.change({ tree: recorded("full", "r"), job: null });
  handlers.change({ tree: recorded("full", "r"), job: null });
  expect(records.count).toBe(1);
  expect(catalogue.find("ash")).toMatchObject({ job: null, tree: { records_sha256: "r" } });
  expect(catalogue.find("oak")).toBeNull();
});
