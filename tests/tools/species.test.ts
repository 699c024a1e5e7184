import { readFileSync, statSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { beforeAll, describe, expect, it } from "vitest";
import { readGlb } from "../../tools/species/glb";
import { describeSprays, drawShoots, drawSprays, type GrownSpecies, growSpecies } from "../../tools/species/grow";
import { SPECIES } from "../../tools/species/parameters";
import { decodePng } from "../../tools/species/pictures/picture";
import { SHEET_ROWS, SHOOT_TILES_PER_SIDE } from "../../web/src/scene/treeModel/sprayTiles";

type Vec = [number, number, number];
type GltfDocument = Awaited<ReturnType<typeof readGlb>>;

interface Skeleton {
  points_m: Vec[];
  radius_m: number[];
  parent: number[];
  branch: number[];
  level: number[];
}

const path = (file: string): string =>
  fileURLToPath(new URL(`../../assets/species/${file}`, import.meta.url));
const listed = JSON.parse(readFileSync(path("species.json"), "utf8")) as {
  id: string;
  file: string;
  species: string;
  form: string;
  height_m: number;
}[];

function part(document: GltfDocument, name: string) {
  const mesh = document
    .getRoot()
    .listMeshes()
    .find((candidate) => candidate.getName() === name);
  const primitive = mesh?.listPrimitives()[0];
  if (!primitive) throw new Error(`no mesh named ${name}`);
  const array = (attribute: string) => primitive.getAttribute(attribute)?.getArray() as ArrayLike<number>;
  return {
    positions: array("POSITION"),
    uvs: array("TEXCOORD_0") ?? [],
    normals: array("NORMAL"),
    indices: primitive.getIndices()?.getArray() as ArrayLike<number>,
    material: primitive.getMaterial(),
  };
}

const point = (positions: ArrayLike<number>, v: number): Vec => [
  positions[3 * v],
  positions[3 * v + 1],
  positions[3 * v + 2],
];
const minus = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vec, b: Vec): Vec => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

function smallestTriangle_m2(positions: ArrayLike<number>, indices: ArrayLike<number>): number {
  let smallest = Number.POSITIVE_INFINITY;
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => point(positions, indices[t + k]));
    smallest = Math.min(smallest, Math.hypot(...cross(minus(b, a), minus(c, a))) / 2);
  }
  return smallest;
}

/** Directed edges of the welded surface without an opposite edge. */
function openEdges(positions: ArrayLike<number>, indices: ArrayLike<number>): number {
  const key = (v: number): string => point(positions, v).join();
  const open = new Set<string>();
  for (let i = 0; i < indices.length; i++) {
    const [from, to] = [key(indices[i]), key(indices[i % 3 === 2 ? i - 2 : i + 1])];
    if (!open.delete(`${to}|${from}`)) open.add(`${from}|${to}`);
  }
  return open.size;
}

function distanceToSegment_m(p: Vec, a: Vec, b: Vec): number {
  const [ab, ap] = [minus(b, a), minus(p, a)];
  const t = Math.min(1, Math.max(0, dot(ap, ab) / dot(ab, ab)));
  return Math.hypot(ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]);
}

it("lists two forms of each of the twelve species with their files", () => {
  expect(listed.map(({ id, file }) => [id, file])).toEqual(SPECIES.map(({ id }) => [id, `${id}.glb`]));
  const woods = new Set(listed.map(({ species }) => species));
  expect(woods.size).toBe(12);
  for (const wood of woods) {
    const forms = listed.filter(({ species }) => species === wood);
    expect(forms.map(({ id, form }) => [id, form])).toEqual([
      [wood, "open"],
      [`${wood}-forest`, "forest"],
    ]);
  }
});

describe.each(SPECIES)("$id", (species) => {
  let committed: GltfDocument;
  let grown: GrownSpecies;
  let regrown: GltfDocument;
  const skeleton = JSON.parse(readFileSync(path(`${species.id}.skeleton.json`), "utf8")) as Skeleton;

  beforeAll(async () => {
    committed = await readGlb(readFileSync(path(`${species.id}.glb`)));
    grown = await growSpecies(species);
    regrown = await readGlb(grown.glb);
  });

  it("is a small file with separate wood, twigs and leaves", () => {
    expect(statSync(path(`${species.id}.glb`)).size).toBeLessThan(2.5e6);
    expect(statSync(path(`${species.id}.skeleton.json`)).size).toBeLessThan(200e3);
    expect(
      committed
        .getRoot()
        .listMeshes()
        .map((mesh) => mesh.getName()),
    ).toEqual(["wood", "twigs", "leaves"]);
    const [wood, twigs, leaves] = ["wood", "twigs", "leaves"].map((name) => part(committed, name));
    expect(wood.indices.length / 3).toBeGreaterThan(1200);
    expect(wood.indices.length / 3).toBeLessThan(3500);
    expect(twigs.positions.length / 3).toBeLessThan(12000);
    expect(leaves.indices.length / 3).toBeGreaterThan(2000);
    expect(leaves.indices.length / 3).toBeLessThan(5600);
    expect(leaves.material?.getAlphaMode()).toBe("MASK");
    expect(leaves.material?.getDoubleSided()).toBe(true);
  });

  it("stands on the ground at the origin and has the height of the species", () => {
    const heights = (name: string): number[] => {
      const { positions } = part(committed, name);
      return Array.from({ length: positions.length / 3 }, (_, v) => positions[3 * v + 1]);
    };
    expect(Math.min(...heights("wood"))).toBeCloseTo(0, 4);
    const top_m = Math.max(...["wood", "twigs", "leaves"].flatMap(heights));
    expect(Math.abs(top_m - species.height_m)).toBeLessThan(1e-3 * species.height_m);
    expect(Math.hypot(...skeleton.points_m[0])).toBeLessThan(1e-6);
  });

  it.each(["wood", "twigs", "leaves"])("has only finite numbers and no degenerate triangle in the %s", (name) => {
    const { positions, normals, uvs, indices } = part(committed, name);
    for (const values of [positions, normals, uvs])
      expect(Array.from(values).every(Number.isFinite)).toBe(true);
    expect(smallestTriangle_m2(positions, indices)).toBeGreaterThan(1e-6);
  });

  it.each(["wood", "twigs"])("has closed %s tubes", (name) => {
    const { positions, indices } = part(committed, name);
    expect(openEdges(positions, indices)).toBe(0);
  });

  it("has a rooted skeleton whose branches start on the axis of their parents", () => {
    const { points_m, parent, branch, level } = skeleton;
    expect(parent.flatMap((p, i) => (p < 0 ? [i] : []))).toEqual([0]);
    expect(parent.every((p, i) => p < i)).toBe(true);
    parent.forEach((below, i) => {
      if (below < 0 || branch[below] === branch[i]) return;
      expect(level[i]).toBe(level[below] + 1);
      const next = parent.findIndex((p, k) => p === below && branch[k] === branch[below]);
      expect(distanceToSegment_m(points_m[i], points_m[below], points_m[next])).toBeLessThan(1e-3);
    });
  });

  it("has a stem radius typical of its size", () => {
    const { points_m, radius_m, parent, level } = skeleton;
    expect(Math.min(...radius_m)).toBeGreaterThanOrEqual(0.005);
    expect(parent.every((below, i) => below < 0 || radius_m[i] <= radius_m[below] + 1e-4)).toBe(true);
    const trunk = points_m.flatMap((p, i) => (level[i] === 0 && p[1] > 0.5 && p[1] < 2 ? [radius_m[i]] : []));
    const [most, least] = species.form === "open" ? [62, 30] : [120, 80]; // height over diameter
    for (const radius of trunk) expect(radius).toBeGreaterThan((0.5 / most) * species.height_m * 0.95);
    for (const radius of trunk) expect(radius).toBeLessThan((0.5 / least) * species.height_m * 1.1);
  });

  it("keeps every leaf card near the wood", () => {
    const { positions } = part(committed, "leaves");
    const { points_m, parent } = skeleton;
    const limit_m = 1.5 * Math.max(...species.twigs.length_m) + species.foliage.size_m;
    for (let v = 0; v < positions.length / 3; v += 4 * 25) {
      const foot = point(positions, v);
      const nearest = parent.map((p, i) =>
        p < 0 ? 1e9 : distanceToSegment_m(foot, points_m[p], points_m[i]),
      );
      expect(Math.min(...nearest)).toBeLessThan(limit_m);
    }
  });

  it("has no fringe: transparent texels beside leaves have the colours of the leaves", () => {
    const texture = committed
      .getRoot()
      .listTextures()
      .find((t) => t.getName() === "leaves");
    const { width, data } = decodePng(texture?.getImage() as Uint8Array);
    const differences: number[] = [];
    for (let i = 1; i < data.length / 4; i++) {
      const besideLeaf = data[4 * i + 3] === 0 && i % width > 0 && data[4 * i - 1] > 200;
      if (besideLeaf) for (const c of [0, 1, 2]) differences.push(Math.abs(data[4 * i + c] - data[4 * i - 4 + c]));
    }
    expect(differences.length).toBeGreaterThan(1000);
    expect(differences.reduce((sum, d) => sum + d, 0) / differences.length).toBeLessThan(25);
  });

  it("reproduces the committed files", () => {
    expect(grown.skeleton).toBe(readFileSync(path(`${species.id}.skeleton.json`), "utf8"));
    for (const name of ["wood", "twigs", "leaves"]) {
      const [old, now] = [part(committed, name), part(regrown, name)];
      expect(now.positions).toEqual(old.positions);
      expect(now.indices).toEqual(old.indices);
      expect(now.uvs).toEqual(old.uvs);
    }
    // Compare pixels, because another zlib may compress the same picture differently.
    const pictures = (document: GltfDocument) =>
      document
        .getRoot()
        .listTextures()
        .map((t) => decodePng(t.getImage() as Uint8Array).data);
    const [old, now] = [pictures(committed), pictures(regrown)];
    expect(now.map((pixels, i) => Buffer.compare(pixels, old[i]))).toEqual(old.map(() => 0));
  });

  it("has a picture of shoots of which none reaches the edge of its tile, so that copies side by side have no cuts", () => {
    const image = part(committed, "leaves").material?.getBaseColorTexture()?.getImage();
    const { width, data } = decodePng(image as Uint8Array);
    const side = width / SHOOT_TILES_PER_SIDE;
    const alpha = (x: number, y: number) => data[4 * (y * width + x) + 3];
    for (let along = 0; along < width; along++) {
      for (let tile = 0; tile < SHOOT_TILES_PER_SIDE; tile++) {
        const [first, last] = [tile * side, tile * side + side - 1];
        expect([alpha(along, first), alpha(along, last), alpha(first, along), alpha(last, along)]).toEqual([0, 0, 0, 0]);
      }
    }
  });
});

it.each(SPECIES.filter(({ form }) => form === "open"))("reproduces the picture of the sprays: $id", (species) => {
  const committed = decodePng(readFileSync(path(`${species.wood}.sprays.png`)));
  const drawn = decodePng(drawSprays(species));
  expect([drawn.width, drawn.height]).toEqual([committed.width, committed.height]);
  expect(Buffer.compare(drawn.data, committed.data)).toBe(0);
  const described = describeSprays(species);
  if (described) expect(described).toBe(readFileSync(path(`${species.wood}.sprays.json`), "utf8"));
  // No leaf is cut off: the edges of the tiles are empty but for the foot of the stem or petiole.
  const side = committed.height / SHEET_ROWS;
  for (let y = 0; y < committed.height; y++) {
    for (let x = 0; x < committed.width; x++) {
      const [left, up] = [x % side, side - 1 - (y % side)];
      const edge = left < 3 || left >= side - 3 || up >= side - 3;
      if (edge) expect(committed.data[4 * (y * committed.width + x) + 3]).toBe(0);
    }
  }
});

it.each(SPECIES.filter(({ form, leaf }) => form === "open" && leaf.fuller))(
  "reproduces the picture of the fuller shoots: $id",
  (species) => {
    const committed = decodePng(readFileSync(path(`${species.wood}.shoots.png`)));
    expect(Buffer.compare(decodePng(drawShoots(species)!).data, committed.data)).toBe(0);
    const side = committed.width / SHOOT_TILES_PER_SIDE;
    for (let y = 0; y < committed.height; y++) {
      for (let x = 0; x < committed.width; x++) {
        const edge = x % side === 0 || x % side === side - 1 || y % side === 0;
        if (edge) expect(committed.data[4 * (y * committed.width + x) + 3]).toBe(0);
      }
    }
  },
  240_000,
);

it("is deterministic", async () => {
  const species = SPECIES[SPECIES.length - 1];
  const [first, second] = [await growSpecies(species), await growSpecies(species)];
  expect(Buffer.compare(first.glb, second.glb)).toBe(0);
});
