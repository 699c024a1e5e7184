import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { decodeTable } from "../../../web/player/src/core/table/table";
import { type Form, kindsOf, plant } from "../../../web/src/scene/forms";
import { glade } from "../../../web/src/scene/ground/landscape";
import {
  ATLAS_BYTES,
  canvasBytes,
  COLOUR_VIEW,
  MOST_ATLASES,
  viewCorner,
} from "../../../web/src/scene/impostors/baking/atlasLayout";
import { Atlas } from "../../../web/src/scene/impostors/baking/atlas";
import { cardMaterials, shared } from "../../../web/src/scene/impostors/cardMaterial";
import type { TreeModel } from "../../../web/player/src/trees/mesh/treeMesh";
import { farPlaces, plantFar, REACH_M, shareDrawn, THINNING_LEVELS } from "../../../web/src/scene/background/farPlaces";
import {
  type Direction,
  directionAt,
  pictureAxes,
  squareAt,
  VIEWS_PER_SIDE,
  viewDirection,
  viewsAround,
} from "../../../web/src/scene/impostors/baking/octahedral";
import { SHADE_M, SHADE_SIDE, shadeOf } from "../../../web/src/scene/impostors/shadeMap";
import { dynamicPressure } from "../../../web/player/src/core/wind/pressure";
import { airDamping, freeStep, Sway } from "../../../web/src/scene/impostors/sway";
import { treeBox } from "../../../web/src/scene/impostors/baking/treeBox";
import { placeTrees, reach_m, SPACING_M } from "../../../web/src/scene/placement";
import { FADE_END, fadeAt } from "../../../web/player/src/trees/crossFade";
import { DrawList, type View } from "../../../web/player/src/trees/drawList";
import { bendNodes } from "../../../web/player/src/core/table/cardLevel";
import { createInstanceData } from "../../../web/player/src/trees/instanceData";
import { oscillatorOf } from "../../../web/player/src/worker/table/firstSway";
import { tableMotion } from "../../../web/player/src/worker/table/tableMotion";
import { seededRandom } from "../seeded";

const dot = (a: Direction, b: Direction) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function someDirections(count: number, seed: number): Direction[] {
  const random = seededRandom(seed);
  return Array.from({ length: count }, () => {
    const [x, y, z] = [2 * random() - 1, random(), 2 * random() - 1];
    const length = Math.hypot(x, y, z);
    return [x / length, y / length, z / length] as const;
  });
}

describe("views of an impostor", () => {
  test("the square covers the upper hemisphere once: there and back is the same", () => {
    for (const direction of someDirections(500, 4711)) {
      expect(dot(directionAt(...squareAt(direction)), direction)).toBeCloseTo(1, 10);
    }
  });

  test("the rim is the horizon", () => {
    for (let k = 0; k < VIEWS_PER_SIDE; k++) {
      for (const [column, row] of [
        [k, 0],
        [k, VIEWS_PER_SIDE - 1],
        [0, k],
        [VIEWS_PER_SIDE - 1, k],
      ]) {
        expect(viewDirection(column, row)[1]).toBeCloseTo(0, 12);
      }
    }
  });

  test("the three views around a direction have weights of sum 1, and their weighted mean in the square is its place", () => {
    for (const direction of someDirections(500, 99)) {
      const views = viewsAround(direction);
      expect(views.reduce((sum, { weight }) => sum + weight, 0)).toBeCloseTo(1, 10);
      for (const { column, row, weight } of views) {
        expect(weight).toBeGreaterThanOrEqual(-1e-12);
        expect(Math.min(column, row)).toBeGreaterThanOrEqual(0);
        expect(Math.max(column, row)).toBeLessThan(VIEWS_PER_SIDE);
      }
      const mean = (of: "column" | "row") => views.reduce((sum, view) => sum + view.weight * view[of], 0);
      const [u, v] = squareAt(direction);
      expect(mean("column")).toBeCloseTo((0.5 * u + 0.5) * (VIEWS_PER_SIDE - 1), 10);
      expect(mean("row")).toBeCloseTo((0.5 * v + 0.5) * (VIEWS_PER_SIDE - 1), 10);
    }
  });

  test("weights change continuously: a turn by a thousandth changes none by more than a few hundredths", () => {
    for (const [x, y, z] of someDirections(300, 7)) {
      const turned: Direction = [x * Math.cos(1e-3) - z * Math.sin(1e-3), y, x * Math.sin(1e-3) + z * Math.cos(1e-3)];
      const all = new Map<number, number>();
      for (const { column, row, weight } of viewsAround([x, y, z])) all.set(row * VIEWS_PER_SIDE + column, weight);
      for (const { column, row, weight } of viewsAround(turned)) {
        expect(Math.abs(weight - (all.get(row * VIEWS_PER_SIDE + column) ?? 0))).toBeLessThan(0.03);
      }
    }
  });

  test("axes of a picture are perpendicular to each other and to the view, and upright", () => {
    for (const direction of someDirections(200, 5)) {
      const { right, up } = pictureAxes(direction);
      for (const product of [dot(right, up), dot(right, direction), dot(up, direction), right[1]]) {
        expect(product).toBeCloseTo(0, 10);
      }
      expect(dot(up, up)).toBeCloseTo(1, 10);
      expect(up[1]).toBeGreaterThanOrEqual(0);
    }
  });
});

describe("atlas", () => {
  test("views do not overlap and fill the picture", () => {
    const taken = new Set<string>();
    for (let view = 0; view < VIEWS_PER_SIDE * VIEWS_PER_SIDE; view++) {
      const { left, bottom } = viewCorner(view, COLOUR_VIEW);
      const [column, row] = [left / COLOUR_VIEW.width, bottom / COLOUR_VIEW.height];
      expect(Math.max(column, row)).toBeLessThan(VIEWS_PER_SIDE);
      taken.add(`${column} ${row}`);
    }
    expect(taken.size).toBe(VIEWS_PER_SIDE * VIEWS_PER_SIDE);
  });

  test("evergreens are drawn with their leaves in every season", () => {
    const model = (evergreen: boolean) => ({ parts: [], evergreen }) as unknown as TreeModel;
    for (const [evergreen, bare] of [[true, false], [false, true]] as const) {
      const atlas = new Atlas(model(evergreen));
      atlas.restart(true);
      expect(atlas.leafless).toBe(bare);
      const materials = cardMaterials(atlas, { uNodes: { value: null }, uNodeShift: { value: 0 }, uShare: { value: 0 } }, null);
      const shader = { uniforms: {} as Record<string, { value: unknown }>, vertexShader: "", fragmentShader: "" };
      materials.colour.onBeforeCompile(shader as never, null as never);
      shared.uBare.value = 1;
      expect(shader.uniforms.uBare.value).toBe(bare ? 1 : 0);
      shared.uBare.value = 0;
      atlas.dispose();
    }
  });

  test("all impostors together take less than 61 MB of graphics memory, also while they are baked", () => {
    expect(MOST_ATLASES * ATLAS_BYTES + canvasBytes(512) + SHADE_SIDE ** 2).toBeLessThan(61e6);
  });

  test("every vertex lies in the unit sphere, and one near its surface", () => {
    const random = seededRandom(31);
    const at = Float32Array.from({ length: 900 }, (_, i) => (i % 3 === 1 ? 17 * random() : 4 * random() - 2));
    const { middle_m, across_m, up_m, height_m } = treeBox([at]);
    let most = 0;
    for (let i = 0; i < at.length; i += 3) {
      const out = Math.hypot(at[i] / across_m, (at[i + 1] - middle_m) / up_m, at[i + 2] / across_m);
      most = Math.max(most, out);
    }
    expect(most).toBeLessThan(1);
    expect(most).toBeGreaterThan(0.95);
    expect(height_m).toBe(Math.max(...at.filter((_, i) => i % 3 === 1)));
  });
});

describe("cross-fade", () => {
  test("at every distance either the geometry or the impostor is complete, and nothing jumps", () => {
    let before = fadeAt(0, 60);
    for (let distance_m = 0; distance_m < 60 * FADE_END + 5; distance_m += 0.05) {
      const fade = fadeAt(distance_m, 60);
      expect(Math.max(fade.card, fade.pieces)).toBe(1);
      expect(Math.abs(fade.card - before.card)).toBeLessThan(0.02);
      expect(Math.abs(fade.pieces - before.pieces)).toBeLessThan(0.02);
      before = fade;
    }
    expect(fadeAt(60, 60)).toEqual({ card: 0, pieces: 1 });
    expect(fadeAt(60 * FADE_END + 1, 60)).toEqual({ card: 1, pieces: 0 });
    expect(fadeAt(1e4, Number.POSITIVE_INFINITY)).toEqual({ card: 0, pieces: 1 });
  });

  test("every visible tree is drawn, near ones as geometry, far ones as impostors; shadows stay the same", () => {
    const instances = createInstanceData(placeTrees(400, 7), () => 0, () => [1, 1, 1, 0]);
    const view: View = {
      planes: [{ normal: { x: 1, y: 0, z: 0 }, constant: 20 }],
      eye: { x: 0, y: 5, z: 20 },
      sun: { x: 0.6, y: 0.52915, z: 0.6 },
      levelFrom_m: [30, 60],
      shadow_m: 100,
    };
    const bounds = { height_m: 10, radius_m: 3, reach_m: 0 };
    const [plain, carded] = [new DrawList(instances), new DrawList(instances)];
    plain.select(bounds, view);
    carded.select(bounds, { ...view, cardsFrom_m: 40 });
    const geometry = (list: DrawList) =>
      new Set(
        [...list.visible].flatMap((count, level) => [
          ...list.order.subarray(list.start[level], list.start[level] + count),
        ]),
      );
    const [all, near] = [geometry(plain), geometry(carded)];
    expect(near.size).toBeLessThan(all.size);
    for (const tree of all) expect(near.has(tree) || carded.card[tree] === 1).toBe(true);
    for (let tree = 0; tree < instances.count; tree++) {
      if (carded.card[tree] > 0) expect(all.has(tree)).toBe(true);
    }
    expect(carded.drawn).toBe(plain.drawn);
    expect([...carded.casters].filter((c) => c > 0).length).toBe([...plain.casters].filter((c) => c > 0).length);
  });
});

const edgeOf = (count: number, seed: number, density = 1) =>
  placeTrees(count, seed, density).reduce((most, place) => Math.max(most, reach_m(place)), 0);

describe("background forest", () => {
  test.each([
    [100, 7, 1],
    [400, 3, 1],
    [1000, 11, 1.6],
  ])("goes on beyond %i planted trees without a gap, an overlap or a tree in the glade", (count, seed, density) => {
    const planted = placeTrees(count, seed, density);
    const edge_m = edgeOf(count, seed, density);
    const far = farPlaces(edge_m, seed, density);
    const ids = new Set(planted.map(({ id }) => id));
    expect(far.some(({ id }) => ids.has(id))).toBe(false);
    expect(far.every(({ x_m, z_m }) => glade(x_m, z_m) < 0.5)).toBe(true);
    const outs = far.map((place) => reach_m(place) - edge_m);
    expect(Math.min(...outs)).toBeGreaterThanOrEqual(0);
    expect(Math.min(...outs)).toBeLessThan(0.5);
    expect(Math.max(...outs) + edge_m).toBeGreaterThan(REACH_M - SPACING_M);
    const nearest_m = Math.min(
      ...far
        .filter((place) => reach_m(place) < edge_m + SPACING_M)
        .map((a) => Math.min(...planted.map((b) => Math.hypot(a.x_m - b.x_m, a.z_m - b.z_m)))),
    );
    expect(nearest_m).toBeGreaterThan(0.5); // as among planted trees
  });

  test("it is as dense as the simulated forest, and fewer of its trees are drawn far from the eye", () => {
    const edge_m = edgeOf(400, 7);
    const far = farPlaces(edge_m, 7, 1);
    const whole = placeTrees(1000, 7).filter((place) => reach_m(place) > edge_m);
    const reach = Math.max(...whole.map(reach_m));
    expect(far.filter((place) => reach_m(place) <= reach).map(({ id }) => id).sort()).toEqual(
      whole.map(({ id }) => id).sort(),
    );
    let before = 1;
    for (let from_m = 0; from_m < 2 * REACH_M; from_m += 10) {
      const share = shareDrawn(from_m, THINNING_LEVELS.low);
      expect(share).toBeLessThanOrEqual(before);
      before = share;
    }
    expect(before).toBe(THINNING_LEVELS.low.least);
  });

  test("shows no regular grid: the places have no preferred phase, and the distances between them vary", () => {
    const far = farPlaces(80, 7, 1);
    for (const phases of [far.map(({ x_m }) => x_m / SPACING_M), far.map(({ z_m }) => z_m / (0.9 * SPACING_M))]) {
      const mean = (of: (turns: number) => number) =>
        phases.reduce((sum, turns) => sum + of(2 * Math.PI * turns), 0) / phases.length;
      expect(Math.hypot(mean(Math.cos), mean(Math.sin))).toBeLessThan(0.3);
    }
    const some = far.filter(({ x_m, z_m }) => Math.hypot(x_m - 100, z_m) < 40);
    const nearest = some.map((a) =>
      Math.min(...some.filter((b) => b !== a).map((b) => Math.hypot(a.x_m - b.x_m, a.z_m - b.z_m))),
    );
    const mean = nearest.reduce((sum, n) => sum + n, 0) / nearest.length;
    const variance = nearest.reduce((sum, n) => sum + (n - mean) ** 2, 0) / nearest.length;
    expect(Math.sqrt(variance) / mean).toBeGreaterThan(0.2);
    expect(new Set(far.map(({ yaw_rad, scale }) => `${yaw_rad} ${scale}`)).size).toBe(far.length);
  });

  test("has at each place the species that would be planted there, and no uploads", () => {
    const tree = (id: string, species: string | null, form: Form, builtin = true) => ({
      id,
      species,
      form,
      builtin,
      hasTable: true,
    });
    const trees = [
      tree("poplar", "poplar", "open"),
      tree("maple", "maple", "open"),
      tree("poplar-forest", "poplar", "forest"),
      tree("maple-forest", "maple", "forest"),
      tree("mine", null, "open", false),
    ];
    const far = farPlaces(60, 7, 1);
    const chosen = plantFar(trees, far, {});
    const usual = plant(trees.slice(0, 4), far, {});
    const kinds = kindsOf(trees.slice(0, 4));
    const kind = (one: unknown) => kinds.findIndex(({ open, forest }) => one === open || one === forest);
    chosen.forEach((k, i) => {
      expect(trees[k].builtin).toBe(true);
      expect(kind(trees[k])).toBe(kind(usual[i]));
    });
    expect(new Set(plantFar(trees, far, { poplar: 0 }))).toEqual(new Set([1, 3]));
    // If all of them are excluded, the background is not left empty.
    expect([...plantFar(trees, far, { poplar: 0, maple: 0 })].every((k) => k >= 0)).toBe(true);
  });
});

describe("sway of background trees", () => {
  test("the step is exact: it agrees with small steps of a Runge-Kutta method", () => {
    const [frequency_hz, damping, dt_s] = [0.49, 0.12, 0.37];
    const omega = 2 * Math.PI * frequency_hz;
    const slope = ([y, v]: number[]) => [v, -2 * damping * omega * v - omega * omega * y];
    let state = [0.3, -0.8];
    const n = 2000;
    for (let k = 0; k < n; k++) {
      const h = dt_s / n;
      const move = (by: number[], t: number) => state.map((s, i) => s + t * by[i]);
      const [a, b] = [slope(state), slope(move(slope(state), h / 2))];
      const c = slope(move(b, h / 2));
      const d = slope(move(c, h));
      state = state.map((s, i) => s + (h / 6) * (a[i] + 2 * b[i] + 2 * c[i] + d[i]));
    }
    const [p, q, r, s] = freeStep(frequency_hz, damping, dt_s);
    expect(0.3 * p - 0.8 * q).toBeCloseTo(state[0], 9);
    expect(0.3 * r - 0.8 * s).toBeCloseTo(state[1], 9);
  });

  test("in steady wind a tree comes to rest in its static displacement, where it is settled too", () => {
    const sway = new Sway({ frequency_hz: 0.4, damping: 0.05, tip_m_pa: 0.001, streamlined: 1.3 }, 15, Float32Array.of(1, 1.2));
    const [trees, x, z] = [[1, 0], Float32Array.of(20, 20), Float32Array.of(10, 0)];
    sway.settle(trees, x, z);
    const first = [...sway.tips];
    sway.advance(0.1, [0], Float32Array.of(40), Float32Array.of(0), 6);
    expect(sway.tips[0]).toBeGreaterThan(first[0]);
    expect([...sway.tips].slice(1)).toEqual(first.slice(1)); // the other tree was not moved
    for (let k = 0; k < 2000; k++) sway.advance(0.1, trees, x, z, 6);
    sway.tips.forEach((tip, i) => {
      expect(tip).toBeCloseTo(first[i], 5);
    });
    expect(first[0]).toBeCloseTo(0.02 / (1 + 0.02 / (0.22 * 15)), 6);
  });

  test("the air damps in proportion to the wind", () => {
    const sway = { frequency_hz: 0.5, damping: 0.03, tip_m_pa: 0.01, streamlined: 2 };
    expect(airDamping(sway, 0)).toBe(0);
    for (const speed of [2, 20]) expect(airDamping(sway, 2 * speed)).toBeCloseTo(2 * airDamping(sway, speed), 10);
    const slope = (n: number, speed: number) => (dynamicPressure(speed + 1e-4, n) - dynamicPressure(speed - 1e-4, n)) / 2e-4;
    for (const n of [1.3, 2]) {
      for (const speed of [2, 20]) {
        const half = Math.PI * sway.frequency_hz * sway.tip_m_pa * slope(n, speed);
        expect(airDamping({ ...sway, streamlined: n }, speed)).toBeCloseTo(half, 6);
      }
    }
  });

  test("an oscillator is recovered from its step", () => {
    const [dt_s, omega, damping] = [1 / 30, 3.1, 0.04];
    const [a, b, c, d] = freeStep(omega / (2 * Math.PI), damping, dt_s);
    // Under a unit force the state rests at 1 / omega².
    const rest = 1 / omega ** 2;
    const found = oscillatorOf([a - 1, b, c, d - 1, rest * (1 - a), -rest * c], dt_s);
    expect(found.frequency_hz).toBeCloseTo(omega / (2 * Math.PI), 9);
    expect(found.damping).toBeCloseTo(damping, 9);
    expect(found.at_rest).toBeCloseTo(rest, 9);
  });

  test.each(["poplar", "maple", "apricot"])("%s: the frequency is that of its report", (species) => {
    const at = (end: string) => new URL(`../../../assets/species/shipped/${species}.${end}`, import.meta.url);
    const { sway, rest_m, height_m } = tableMotion("", decodeTable(new Uint8Array(readFileSync(at("table")))), 0);
    const text = readFileSync(at("json"), "utf8");
    const reported = Number(/"first_frequency_hz": ([\d.]+)/.exec(text)?.[1]);
    expect(Math.abs(sway.frequency_hz / reported - 1)).toBeLessThan(1e-3);
    expect(sway.tip_m_pa).toBeGreaterThan(0);
    const { middle, tip, middleAt } = bendNodes({ rest_m, height_m });
    expect(rest_m[3 * tip + 1]).toBeGreaterThan(0.8 * height_m);
    expect(rest_m[3 * middle + 1]).toBeLessThan(rest_m[3 * tip + 1]);
    expect(middleAt).toBeCloseTo(rest_m[3 * middle + 1] / rest_m[3 * tip + 1], 6);
  });
});

describe("shadows on distant ground", () => {
  const shadeAt = (map: Uint8Array, x: number, z: number) => {
    const texel = (at: number) => Math.round(((at + SHADE_M / 2) / SHADE_M) * SHADE_SIDE - 0.5);
    return map[texel(z) * SHADE_SIDE + texel(x)];
  };

  test("lie opposite to the sun, at the height of the crown over the slope of the light", () => {
    const map = shadeOf([50, -80, 20, 4], { x: 0.6, y: 0.6, z: 0.5291 });
    // Crown between 7 and 18 m, hence a shadow from 7 to 18 m along x.
    expect(shadeAt(map, 50 - 12, -80 - 12 * (0.5291 / 0.6))).toBeGreaterThan(100);
    expect(shadeAt(map, 50 + 12, -80 + 12)).toBe(0);
    expect(shadeAt(map, 50, -40)).toBe(0);
  });

  test("a low sun casts long shadows of limited length; trees at the rim are harmless", () => {
    const low = shadeOf([0, 0, 20, 4], { x: 1, y: 0.001, z: 0 });
    expect(shadeAt(low, -40, 0)).toBeGreaterThan(50);
    expect(shadeAt(low, -60, 0)).toBe(0);
    const rim = shadeOf([SHADE_M / 2, SHADE_M / 2, 20, 4], { x: -1, y: 0.1, z: -1 });
    expect(rim.reduce((most, shade) => Math.max(most, shade), 0)).toBe(0); // its shadow lies outside
  });
});
