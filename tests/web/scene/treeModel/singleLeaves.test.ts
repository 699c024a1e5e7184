/** The leaves that are drawn one by one close to the eye, against the pictures of the sprays that they replace. */
import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { decodePng } from "../../../../tools/species/pictures/picture";
import { seededRandom } from "../../../../tools/species/random";
import { SPRAY_FLOATS } from "../../../../web/player/src/trees/mesh/singleLeaves";
import {
  ARCH_SHARE,
  HANG_SHARE,
  leafSprays,
  SPRAY_VERTICES,
  SPRAYS_PER_CARD,
} from "../../../../web/src/scene/treeModel/leafSprays";
import { cross, dot, minus, type Point, plus, unit } from "../../../../web/src/scene/treeModel/points";
import { BLADE_VERTICES, placedSprays, sprayShapes } from "../../../../web/src/scene/treeModel/singleLeaves";
import { type DrawnSprays, SHEET_ROWS, SPRAY_TILES } from "../../../../web/src/scene/treeModel/sprayTiles";

const SPECIES = ["maple", "birch", "willow"];
const SEED = 29;
console.log("seed", SEED);

const file = (name: string) => readFileSync(`assets/species/${name}`);
const at = (values: ArrayLike<number>, v: number): Point => [values[3 * v], values[3 * v + 1], values[3 * v + 2]];

describe.each(SPECIES)("single leaves of the %s", (species) => {
  const drawn = JSON.parse(file(`${species}.sprays.json`).toString()) as DrawnSprays;
  const picture = decodePng(file(`${species}.sprays.png`));
  const side_px = picture.height / SHEET_ROWS;
  const shapes = sprayShapes(drawn);
  /** Coverage, 0..1, at a point of a tile. */
  const cover = (tile: number, x: number, y: number) => {
    const column = Math.floor(((tile % SPRAY_TILES.columns) + x) * side_px);
    const row = Math.floor((Math.floor(tile / SPRAY_TILES.columns) + 1 - y) * side_px);
    return picture.data[4 * (row * picture.width + column) + 3] / 255;
  };

  test("stand where the picture of their spray shows them", () => {
    expect(shapes.length).toBe(SPRAY_TILES.columns * SPRAY_TILES.rows);
    shapes.forEach(({ positions, leaves }, tile) => {
      drawn.tiles[tile].leaves.forEach(([x, y, angle_rad, side], k) => {
        const first = k * BLADE_VERTICES;
        const foot = at(positions, first + 1); // of the midrib
        expect(Math.hypot(...minus(foot, [x - 0.5, y, 4 * ARCH_SHARE * y * (1 - y)]))).toBeLessThan(1e-6);
        expect(leaves.slice(4 * first, 4 * first + 3)).toEqual(Float32Array.from(foot));
        // Seen from above, a straight leaf of this length ends about where the picture has one; bent ones are shorter.
        const middle = at(positions, first + 4);
        const away = Math.hypot(middle[0] - foot[0], middle[1] - foot[1]);
        expect(away).toBeLessThan(0.5 * side + 1e-6);
        expect(away).toBeGreaterThan(0.3 * side);
        const angle = Math.atan2(middle[0] - foot[0], middle[1] - foot[1]) - angle_rad;
        expect(Math.abs(Math.atan2(Math.sin(angle), Math.cos(angle)))).toBeLessThan(0.45);
      });
    });
  });

  test("cover what the picture covers: there is a leaf under the middle of each blade", () => {
    let covered = 0;
    let blades = 0;
    drawn.tiles.forEach(({ leaves }, tile) => {
      for (const [x, y, angle_rad, side] of leaves) {
        const along = side * (drawn.petiole + 0.5 * (1 - drawn.petiole));
        covered += cover(tile, x + along * Math.sin(angle_rad), y + along * Math.cos(angle_rad));
        blades++;
      }
    });
    expect(covered / blades).toBeGreaterThan(0.97);
  });

  test("have the tile of a single leaf on them, whole, and its width", () => {
    for (const [tile, { positions, uvs, leaves }] of shapes.entries()) {
      const column = tile % SPRAY_TILES.columns;
      for (let v = 0; v < uvs.length / 2; v++) {
        expect(Math.floor(SPRAY_TILES.columns * uvs[2 * v])).toBe(column);
        expect(uvs[2 * v + 1]).toBeGreaterThan(SPRAY_TILES.rows / SHEET_ROWS - 1e-6);
        if (leaves[4 * v + 3] > 0) continue;
        const [x, y] = [SPRAY_TILES.columns * uvs[2 * v] - column, SHEET_ROWS * (1 - uvs[2 * v + 1])];
        expect(cover(SPRAY_TILES.columns * SPRAY_TILES.rows + column, x, y)).toBe(1); // the petiole
      }
      drawn.tiles[tile].leaves.forEach(([, , , side], k) => {
        const row = k * BLADE_VERTICES + 3;
        const [left, middle, right] = [0, 1, 2].map((c) => at(positions, row + c));
        for (const edge of [left, right])
          expect(Math.hypot(...minus(edge, middle))).toBeCloseTo(drawn.half * side, 5);
      });
    }
    // Beyond that width the tile is empty.
    for (let column = 0; column < SPRAY_TILES.columns; column++) {
      for (let y = 0.01; y < 1; y += 0.01) {
        for (const x of [0.5 - drawn.half - 0.012, 0.5 + drawn.half + 0.012]) {
          if (x < 0 || x >= 1) continue;
          expect(cover(SPRAY_TILES.columns * SPRAY_TILES.rows + column, x, y)).toBe(0);
        }
      }
    }
  });

  test("have normals of unit length, perpendicular to their blades", () => {
    for (const { positions, normals, index, leaves } of shapes) {
      for (let t = 0; t < index.length; t += 3) {
        const [a, b, c] = [...index.subarray(t, t + 3)];
        expect(Math.hypot(...at(normals, a))).toBeCloseTo(1, 5);
        if (leaves[4 * a + 3] === 0) continue;
        const face = unit(
          cross(minus(at(positions, b), at(positions, a)), minus(at(positions, c), at(positions, a))),
        );
        expect(Math.abs(dot(face, at(normals, a)))).toBeGreaterThan(0.65);
      }
    }
  });
});

test("a spray of single leaves lies on the spray that it replaces", () => {
  const random = seededRandom(SEED);
  const direction = (): Point =>
    unit([random.around(0, 1), random.around(0, 1), random.around(0, 1)]);
  const count = 40;
  const positions = new Float32Array(12 * count);
  for (let card = 0; card < count; card++) {
    const up = direction();
    const across = unit(cross(up, direction()));
    const corners = [-0.5, 0.5, 0.5, -0.5].map((u, k) =>
      plus(plus([card, 0, 0], across, 0.6 * u), up, k < 2 ? 0 : 0.6),
    );
    positions.set(corners.flat(), 12 * card);
  }
  const cards = { positions, first: Uint32Array.from({ length: count }, (_, card) => 4 * card) };
  const mesh = leafSprays(cards);
  const { shapeOf, card, sprays } = placedSprays(cards, {
    crown: () => [0, 1, 0],
    colour: () => [1, 1, 1],
    openness: () => 1,
    limb: () => -1,
  });
  expect(shapeOf.length).toBe(count * SPRAYS_PER_CARD);
  for (let number = 0; number < shapeOf.length; number++) {
    expect(card[number]).toBe(4 * Math.floor(number / SPRAYS_PER_CARD));
    const own = sprays.subarray(number * SPRAY_FLOATS, (number + 1) * SPRAY_FLOATS);
    const [foot, long, facing] = [0, 4, 8].map((from) => [...own.subarray(from, from + 3)] as unknown as Point);
    const length = Math.hypot(...long);
    const across = cross(unit(long), facing);
    for (let k = 0; k < SPRAY_VERTICES; k++) {
      const vertex = number * SPRAY_VERTICES + k;
      // where the shader of the single leaves puts this corner of the tile
      const v = SHEET_ROWS * (1 - mesh.uvs[2 * vertex + 1]) - (SHEET_ROWS - 1 - Math.floor(shapeOf[number] / SPRAY_TILES.columns));
      const u = SPRAY_TILES.columns * mesh.uvs[2 * vertex] - (shapeOf[number] % SPRAY_TILES.columns);
      const arch = 4 * ARCH_SHARE * v * (1 - v);
      const flat = plus(plus(plus(foot, across, own[11] * (u - 0.5) * length), long, v), facing, arch * length);
      const placed: Point = [flat[0], flat[1] - HANG_SHARE * length * v * v, flat[2]];
      expect(Math.hypot(...minus(placed, at(mesh.positions, vertex)))).toBeLessThan(1e-5);
    }
  }
});
