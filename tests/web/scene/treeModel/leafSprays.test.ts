/** The sprays that stand in for leaf cards near the eye. */
import { describe, expect, test } from "vitest";
import { seededRandom } from "../../../../tools/species/random";
import { leafSize, MOST_SHARE, nearRank, pieceSize, sharesOf } from "../../../../web/player/src/trees/detail";
import { forEachSpray, leafSprays, OF_LEAVES, OF_NEEDLES, SPRAY_VERTICES, SPRAYS_PER_CARD, type SprayHabit } from "../../../../web/src/scene/treeModel/leafSprays";
import { type Point, cross, dot, minus, plus, unit } from "../../../../web/src/scene/treeModel/points";
import { SHEET_ROWS, SPRAY_TILES } from "../../../../web/src/scene/treeModel/sprayTiles";

const CARD_COUNT = 60;
const SEED = 83;
console.log("seed", SEED);
const random = seededRandom(SEED);
const direction = (): Point => unit([random.around(0, 1), random.around(0, 1), random.around(0, 1)]);

/** Square cards in all directions, and the side of each. */
function cards(): { positions: Float32Array; first: Uint32Array; sides_m: number[] } {
  const positions = new Float32Array(12 * CARD_COUNT);
  const sides_m = Array.from({ length: CARD_COUNT }, (_, card) => {
    const [foot, up] = [direction(), direction()];
    const across = unit(cross(up, direction()));
    const side_m = random.uniform(0.4, 0.8);
    const corners = [-0.5, 0.5, 0.5, -0.5].map((u, k) =>
      plus(plus(foot, across, u * side_m), up, k < 2 ? 0 : side_m),
    );
    positions.set(corners.flat(), 12 * card);
    return side_m;
  });
  return { positions, first: Uint32Array.from({ length: CARD_COUNT }, (_, card) => 4 * card), sides_m };
}

const { sides_m, ...given } = cards();
const mesh = leafSprays(given);
const at = (values: Float32Array, v: number): Point => [values[3 * v], values[3 * v + 1], values[3 * v + 2]];

/** Twice the area of each triangle as a vector, by card. */
function areas(card: number): Point[] {
  const perCard = mesh.index.length / CARD_COUNT;
  return Array.from({ length: perCard / 3 }, (_, t) => {
    const [a, b, c] = [0, 1, 2].map((k) => at(mesh.positions, mesh.index[card * perCard + 3 * t + k]));
    return cross(minus(b, a), minus(c, a));
  });
}

describe("sprays in place of leaf cards", () => {
  test("stay about their card and within its reach, and stand on its shoot", () => {
    for (let v = 0; v < mesh.card.length; v++) {
      const card = Math.floor(v / (SPRAY_VERTICES * SPRAYS_PER_CARD));
      expect(mesh.card[v]).toBe(4 * card);
      const corners = [0, 1, 2, 3].map((k) => at(given.positions, 4 * card + k));
      const foot = corners[0].map((x, axis) => 0.5 * (x + corners[1][axis])) as unknown as Point;
      const up = minus(corners[3], corners[0]);
      const base = minus(at(mesh.bases, v), foot);
      const along = dot(base, up) / dot(up, up);
      expect(along).toBeGreaterThan(0);
      expect(along).toBeLessThan(0.5);
      expect(Math.hypot(...plus(base, up, -along))).toBeLessThan(0.1 * sides_m[card]);
      const middle = plus(foot, up, 0.5);
      expect(Math.hypot(...minus(at(mesh.positions, v), middle))).toBeLessThan(1.05 * sides_m[card]);
    }
  });

  test("show much of their area from nearly every side, where a card is a line from some", () => {
    const shares = Array.from({ length: CARD_COUNT }, (_, card) => {
      const faces = areas(card);
      const whole = faces.reduce((sum, face) => sum + Math.hypot(...face), 0);
      return Array.from({ length: 40 }, () => {
        const view = direction();
        return faces.reduce((sum, face) => sum + Math.abs(dot(face, view)), 0) / whole;
      });
    }).flat();
    shares.sort((a, b) => a - b);
    expect(shares[Math.floor(0.02 * shares.length)]).toBeGreaterThan(0.2); // of cards: 0.02
    expect(shares.reduce((sum, share) => sum + share, 0) / shares.length).toBeCloseTo(0.5, 1);
  });

  test("have as much area as their card, so that crowns are as dense", () => {
    for (let card = 0; card < CARD_COUNT; card++) {
      const area = areas(card).reduce((sum, face) => sum + 0.5 * Math.hypot(...face), 0);
      expect(area / sides_m[card] ** 2).toBeGreaterThan(1.6);
      expect(area / sides_m[card] ** 2).toBeLessThan(2.9);
    }
  });

  test("of needles lie nearer to the shoot, and their tips hang lower", () => {
    const meanAngle = (habit: SprayHabit) => {
      let sum = 0;
      forEachSpray(given, habit, ({ axis }, _, first) => {
        sum += Math.acos(dot(axis, unit(minus(at(given.positions, first + 3), at(given.positions, first)))));
      });
      return sum / (CARD_COUNT * SPRAYS_PER_CARD);
    };
    expect(meanAngle(OF_NEEDLES)).toBeLessThan(0.6 * meanAngle(OF_LEAVES));
    const height = (habit: SprayHabit) => leafSprays(given, habit).positions.reduce((sum, y, k) => sum + (k % 3 === 1 ? y : 0), 0);
    const sameSides = { ...OF_NEEDLES, hang_share: OF_LEAVES.hang_share };
    expect(height(OF_NEEDLES)).toBeLessThan(height(sameSides));
  });

  test("show each a whole tile of the picture, mirrored or not", () => {
    const tiles = new Set<string>();
    for (let first = 0; first < mesh.card.length; first += SPRAY_VERTICES) {
      const us = Array.from({ length: SPRAY_VERTICES }, (_, k) => SPRAY_TILES.columns * mesh.uvs[2 * (first + k)]);
      const vs = Array.from({ length: SPRAY_VERTICES }, (_, k) => SHEET_ROWS * mesh.uvs[2 * (first + k) + 1]);
      expect(Math.max(...us) - Math.min(...us)).toBeCloseTo(1, 5);
      expect(Math.max(...vs) - Math.min(...vs)).toBeCloseTo(1, 5);
      expect(Math.max(...vs)).toBe(vs[0]); // the foot of the picture is at its lower edge
      tiles.add(`${Math.min(...us)} ${Math.min(...vs)} ${us[0] < us[1]}`);
    }
    expect(tiles.size).toBe(16);
  });
});

describe("the change from cards to sprays", () => {
  test("begins at the distance that the view gives and is complete at 0.6 of it", () => {
    expect(sharesOf([52, 120], 24)(24)).toBe(1);
    expect(sharesOf([52, 120], 24)(23.99)).toBeCloseTo(1, 2);
    expect(sharesOf([52, 120], 24)(0.6 * 24)).toBeCloseTo(MOST_SHARE, 9);
    expect(sharesOf([52, 120], 24)(1)).toBe(MOST_SHARE);
    expect(sharesOf([52, 120])(1)).toBe(1);
  });

  test("shows each card or its sprays, and never less than half of both", () => {
    for (let k = 0; k <= 200; k++) {
      const share = 1 + k / 200;
      for (const rank of [0, 0.1, 0.5, 0.9, 0.999]) {
        const [card, spray] = [leafSize(rank, share), leafSize(nearRank(rank), share)];
        expect(spray).toBe(pieceSize(nearRank(rank), share));
        expect(card + spray).toBeCloseTo(1, 9);
        if (share === 1) expect(card).toBe(1);
        if (share === MOST_SHARE) expect(spray).toBe(1);
      }
    }
  });
});
