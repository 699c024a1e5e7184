import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { type Material, Mesh, MeshStandardMaterial, type Object3D, Texture } from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { expect, test, vi } from "vitest";
import { grownLeaf, pieceSize } from "../../../../web/player/src/trees/detail";
import { openMesh } from "../../../../web/player/src/trees/mesh/openMesh";
import { readMeshes } from "../../../../web/player/src/trees/mesh/partArrays";
import { disposeModel, openedMeshes, type TreeModel } from "../../../../web/player/src/trees/mesh/treeMesh";
import { goldenJson } from "../../golden";

const JSON_AT = 20;

/** A mesh of a built-in tree without its pictures, which need a browser. */
function meshWithoutPictures(file: string): ArrayBuffer {
  const glb = readFileSync(fileURLToPath(new URL(`../../../../assets/species/${file}`, import.meta.url)));
  const size = glb.readUInt32LE(12);
  const document = JSON.parse(glb.toString("utf8", JSON_AT, JSON_AT + size));
  for (const material of document.materials) {
    delete material.normalTexture;
    delete material.pbrMetallicRoughness.baseColorTexture;
  }
  const { textures, images, samplers, ...rest } = document;
  glb.write(JSON.stringify(rest).padEnd(size), JSON_AT);
  return new Uint8Array(glb).buffer;
}

test("a compressed mesh has the pieces of the mesh that it stands for", { timeout: 60_000 }, async () => {
  const [plain, light] = await Promise.all(
    ["shipped", "light"].map(async (folder) =>
      readMeshes(openedMeshes(await openMesh(meshWithoutPictures(`${folder}/apricot-forest.glb`))).meshes),
    ),
  );
  expect(light.height_m).toBeCloseTo(plain.height_m, 3);
  expect(light.read.map(({ geometry }) => geometry.kind)).toEqual(["wood", "twigs", "leaves"]);
  light.read.forEach(({ part, geometry }, k) => {
    const expected = plain.read[k];
    expect(geometry.pieces.count).toBe(expected.geometry.pieces.count);
    expect(geometry.pieces.ofVertex).toEqual(expected.geometry.pieces.ofVertex);
    expect(part.counts).toEqual(expected.part.counts);
    const [found, wanted] = [part.normals, expected.part.normals];
    for (let i = 0; i < wanted.length; i++) expect(Math.abs(found[i] - wanted[i])).toBeLessThan(0.03);
  });
});

interface Levels {
  tree: string;
  share: number;
  every: number;
  parts: { triangles: number[]; rank: number[]; drawn_m: number[][] }[];
}

test("levels of detail show what exports write into their files", { timeout: 60_000 }, async () => {
  const expected = goldenJson<Levels>("levels.json");
  const { share, every } = expected;
  const { read } = readMeshes(openedMeshes(await openMesh(meshWithoutPictures("shipped/apricot-forest.glb"))).meshes);
  expect(read).toHaveLength(expected.parts.length);
  read.forEach(({ part, geometry }, p) => {
    const { triangles, rank, drawn_m } = expected.parts[p];
    expect(part.counts).toEqual(triangles.map((count) => 3 * count));
    const three = (rows: ArrayLike<number>, step: number, v: number) =>
      [0, 1, 2].map((axis) => rows[step * v + axis]);
    rank.forEach((wanted, k) => {
      const v = every * k;
      const found = part.pieces[4 * v + 3];
      expect(found).toBeCloseTo(wanted, 6);
      const [at, anchor] = [three(part.positions, 3, v), three(part.anchors, 4, v)];
      const size = pieceSize(found, share);
      const drawn =
        geometry.kind === "leaves"
          ? grownLeaf(at, anchor, found, share)
          : at.map((value, axis) => anchor[axis] + size * (value - anchor[axis]));
      drawn.forEach((value, axis) => expect(value).toBeCloseTo(drawn_m[k][axis], 4));
    });
  });
});

test("a compressed mesh without WebAssembly names what a Content-Security-Policy must allow", async () => {
  const refused = vi.spyOn(MeshoptDecoder, "decodeGltfBufferAsync");
  refused.mockImplementation(() => Promise.reject(new WebAssembly.CompileError("unsafe-eval")));
  await expect(openMesh(meshWithoutPictures("light/apricot-forest.glb"))).rejects.toThrow(/'wasm-unsafe-eval'/);
  vi.restoreAllMocks();
});

test("pictures inside of a mesh are decoded without an address, each once", async () => {
  vi.stubGlobal("self", globalThis);
  const decoded: Blob[] = [];
  vi.stubGlobal("createImageBitmap", (from: Blob) => {
    decoded.push(from);
    return Promise.resolve({ width: 4, height: 4, close() {} });
  });
  const addresses = vi.spyOn(URL, "createObjectURL");
  const glb = readFileSync(
    fileURLToPath(new URL("../../../../assets/species/shipped/apricot-forest.glb", import.meta.url)),
  );
  const scene = await openMesh(new Uint8Array(glb).buffer);
  expect(addresses).not.toHaveBeenCalled();
  expect(decoded.map(({ type }) => type)).toEqual(["image/png", "image/png", "image/png"]);
  const maps: unknown[] = [];
  scene.traverse((part) => {
    if (part instanceof Mesh) maps.push(...[part.material.map, part.material.normalMap].filter((one) => one));
  });
  expect(maps).toHaveLength(3);
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

test("a mesh whose picture cannot be loaded is refused", async () => {
  vi.stubGlobal("self", globalThis); // as in a browser, where pictures are fetched
  vi.stubGlobal("createImageBitmap", () => Promise.reject(new Error("no picture")));
  const complaints = vi.spyOn(console, "error").mockImplementation(() => {});
  const glb = readFileSync(
    fileURLToPath(new URL("../../../../assets/species/light/apricot-forest.glb", import.meta.url)),
  );
  const bytes = new Uint8Array(glb).buffer;
  await expect(openMesh(bytes, "http://127.0.0.1:9/")).rejects.toThrow(/apricot-/);
  expect(complaints).toHaveBeenCalled();
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

/** The textures of a scene. */
function texturesOf(scene: Object3D): Texture[] {
  const found = new Set<Texture>();
  scene.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    for (const one of Object.values(part.material as Material)) if (one instanceof Texture) found.add(one);
  });
  return [...found];
}

test("pictures of their own are loaded once, and forgotten with the last tree that shows them", async () => {
  vi.stubGlobal("self", globalThis);
  vi.stubGlobal("createImageBitmap", () => Promise.resolve({ width: 4, height: 4, close() {} }));
  let broken = "";
  const fetched: string[] = [];
  vi.stubGlobal("fetch", (input: RequestInfo | URL) => {
    const url = input instanceof Request ? input.url : String(input);
    fetched.push(url);
    return url.includes(broken || "none") ? Promise.reject(new Error("no network")) : Promise.resolve(new Response(new Blob(["x"])));
  });
  vi.spyOn(console, "error").mockImplementation(() => {});
  const glb = readFileSync(fileURLToPath(new URL("../../../../assets/species/light/apricot-forest.glb", import.meta.url)));
  const open = () => openMesh(new Uint8Array(glb).buffer, "http://pictures.test/");
  const first = await open();
  const count = fetched.length;
  expect(count).toBeGreaterThan(1);
  const second = await open();
  expect(fetched).toHaveLength(count);
  for (const texture of texturesOf(first)) texture.dispose();
  const third = await open();
  expect(fetched).toHaveLength(count); // the second shows them still
  for (const scene of [second, third]) for (const texture of texturesOf(scene)) texture.dispose();
  const fourth = await open();
  expect(fetched).toHaveLength(2 * count);
  for (const texture of texturesOf(fourth)) texture.dispose();
  // a mesh that is refused keeps none of the pictures that could be loaded
  [broken] = [fetched[0].slice(fetched[0].lastIndexOf("/"))];
  await expect(open()).rejects.toThrow(/no picture/);
  broken = "";
  await open();
  expect(fetched).toHaveLength(4 * count);
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

test("a model that is disposed of disposes of all its textures", () => {
  const textures = { map: new Texture(), normalMap: new Texture(), roughnessMap: new Texture(), aoMap: new Texture() };
  const freed = vi.fn();
  for (const texture of Object.values(textures)) texture.addEventListener("dispose", freed);
  disposeModel({ materials: [new MeshStandardMaterial(textures)] } as unknown as TreeModel);
  expect(freed).toHaveBeenCalledTimes(4);
});
