import { type Box3, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { groundHeight_m } from "../../../web/src/scene/ground/landscape";
import { Lattice } from "../../../web/src/scene/ground/lattice";
import { Trunks } from "../../../web/src/scene/ground/trunks";
import { KIND_LOOKS, PLANT_KINDS, seenIn } from "../../../web/src/scene/ground/plantKinds";
import { clearance_m, fernAt, leafAt, logAt, saplingAt, shrubAt, stoneAt, stumpAt } from "../../../web/src/scene/ground/undergrowthPlaces";
import { placeTrees } from "../../../web/src/scene/placement";
import { undergrowthTint } from "../../../web/src/scene/season/palette";
import { CROWN_FLOATS } from "../../../web/src/scene/sky/exposure";
import { SEASON_LOOKS, SEASONS, type Season } from "../../../web/src/scene/season/season";
import { PLANT_SIDE, paintPlants } from "../../../web/src/scene/textures/plantPictures";
import { seededRandom } from "../seeded";

const places = placeTrees(400, 7);
const crowns = Float32Array.from(
  places.flatMap(({ x_m, z_m }) => [x_m, groundHeight_m(x_m, z_m) + 8, z_m, 2.5, 4.5, 0.5, 0.3, 0.05, 1]),
);
const trunks = new Trunks(crowns);

/** Distance to the nearest trunk, by looking at all of them. */
const nearest_m = (x: number, z: number) =>
  Math.min(...places.map(({ x_m, z_m }) => Math.hypot(Math.fround(x_m) - x, Math.fround(z_m) - z)));

describe("trunks", () => {
  it("finds the nearest one within its cells, as a search of all does", () => {
    const random = seededRandom(21);
    for (let k = 0; k < 500; k++) {
      const [x, z] = [120 * (random() - 0.5), 120 * (random() - 0.5) - 26];
      const expected = nearest_m(x, z);
      const found = trunks.nearest(x, z);
      if (expected < 8) {
        expect(found.away_m).toBeCloseTo(expected, 9);
        expect(crowns[found.crown]).toBeCloseTo(x, -2);
      } else expect(found.away_m).toBeGreaterThanOrEqual(expected - 1e-9);
    }
    expect(new Trunks(new Float32Array(0)).nearest(0, 0).away_m).toBe(Number.POSITIVE_INFINITY);
  });
});

describe("undergrowth", () => {
  it("never stands in a trunk", () => {
    let grown = 0;
    for (const [kind, grow, spacing_m] of [
      ["shrub", shrubAt, 2.2],
      ["fern", fernAt, 1.15],
      ["sapling", saplingAt, 3.3],
      ["stone", stoneAt, 4.1],
      ["stump", stumpAt, 8.3],
    ] as const) {
      let own = 0;
      for (let row = -40; row < 20; row++) {
        for (let column = -30; column < 30; column++) {
          const { x, z, size_m } = grow(column, row, spacing_m, trunks);
          if (size_m === 0) continue;
          grown++;
          own++;
          expect(nearest_m(x, z)).toBeGreaterThanOrEqual(clearance_m(kind, size_m));
          // The foliage is about as wide as high: its inner half keeps clear of any trunk.
          expect(nearest_m(x, z)).toBeGreaterThan(0.5 * size_m + 0.4);
        }
      }
      expect(own).toBeGreaterThan(5);
    }
    expect(grown).toBeGreaterThan(100);
  });

  it("lays no fallen trunk across a standing one, along its whole length", () => {
    let lying = 0;
    for (let row = -15; row < 8; row++) {
      for (let column = -12; column < 12; column++) {
        const { x, z, size_m, turn } = logAt(column, row, 10, trunks);
        if (size_m === 0) continue;
        lying++;
        const angle = 2 * Math.PI * turn;
        for (let share = -0.5; share <= 0.5; share += 0.05) {
          const [along, across] = [share * size_m * Math.cos(angle), share * size_m * Math.sin(angle)];
          expect(nearest_m(x + along, z + across)).toBeGreaterThan(0.4);
        }
      }
    }
    expect(lying).toBeGreaterThan(10);
  });

  it("has bodies of about the size they are scaled to, with normals that point outwards", () => {
    for (const kind of ["stone", "log", "stump", "mushroom"] as const) {
      const geometry = KIND_LOOKS[kind].shape();
      geometry.computeBoundingBox();
      const box = geometry.boundingBox as Box3;
      const size = kind === "log" ? box.max.x - box.min.x : box.max.y - box.min.y;
      expect(size, kind).toBeGreaterThan(0.8);
      expect(size, kind).toBeLessThan(1.3);
      const [position, normal] = [geometry.getAttribute("position"), geometry.getAttribute("normal")];
      const middle = box.getCenter(new Vector3());
      let outwards = 0;
      for (let v = 0; v < position.count; v++) {
        const out = new Vector3().fromBufferAttribute(position, v).sub(middle);
        if (kind === "log") out.x = 0;
        if (out.dot(new Vector3().fromBufferAttribute(normal, v)) > 0) outwards++;
      }
      expect(outwards / position.count, kind).toBeGreaterThan(0.7);
    }
  });

  it("shows what is not covered by snow in winter, and mushrooms in autumn only", () => {
    const seen = (season: Season) => PLANT_KINDS.filter((kind) => seenIn(kind, season));
    expect(seen("winter")).toEqual(["shrub", "sapling", "stone", "log", "stump"]);
    expect(seen("autumn")).toEqual([...PLANT_KINDS]);
    expect(seen("summer")).toEqual(PLANT_KINDS.filter((kind) => kind !== "mushroom"));
  });

  it("covers the ground below crowns with leaves in autumn, hardly in summer", () => {
    const count = (fallen: number, below: boolean) => {
      let sum = 0;
      for (let row = -90; row < -50; row++) {
        for (let column = -40; column < 40; column++) {
          const leaf = leafAt(column, row, 0.35, trunks, fallen);
          if (leaf.size_m === 0) continue;
          const away_m = nearest_m(leaf.x, leaf.z);
          if (away_m < 2.5 === below) sum++;
          if (away_m < 0.34) throw new Error("a leaf in a trunk");
        }
      }
      return sum;
    };
    const { autumn, summer } = SEASON_LOOKS;
    expect(count(autumn.fallen, true)).toBeGreaterThan(8 * count(summer.fallen, true));
    expect(count(autumn.fallen, true)).toBeGreaterThan(100);
  });

  it("leaves the ground below evergreens without fallen leaves", () => {
    const evergreens = new Trunks(crowns.map((value, k) => (k % CROWN_FLOATS === CROWN_FLOATS - 1 ? 0 : value)));
    const count = (trunks: Trunks) => {
      let sum = 0;
      for (let row = -60; row < 60; row++) {
        for (let column = -60; column < 60; column++) {
          if (leafAt(column, row, 0.35, trunks, SEASON_LOOKS.autumn.fallen).size_m > 0) sum++;
        }
      }
      return sum;
    };
    expect(count(trunks)).toBeGreaterThan(100);
    expect(count(evergreens)).toBe(0);
  });

  it("takes the colour of fallen leaves from their tree in autumn, and all colours are valid", () => {
    const crown = [0.5, 0.03, 0.02] as const;
    const [r, g] = undergrowthTint("leaf", 0, "autumn", crown);
    expect(r / g).toBeCloseTo(crown[0] / crown[1], 6);
    for (const season of SEASONS) {
      for (const kind of ["shrub", "sapling", "fern", "herb", "leaf"] as const) {
        for (const value of undergrowthTint(kind, 0.7, season, crown)) {
          expect(value).toBeGreaterThan(0);
          expect(value).toBeLessThan(1);
        }
      }
    }
  });

  it("keeps plants in place while the camera moves", () => {
    const slots = new Map<number, string>();
    expect(new Lattice(8, 1.5, () => undefined).reach_m).toBe(5.25);
    const lattice = new Lattice(8, 1.5, (slot, column, row) => slots.set(slot, `${column},${row}`));
    const random = seededRandom(22);
    const eye = { x: 0, z: 0 };
    for (let k = 0; k < 60; k++) {
      lattice.update(eye);
      const [column, row] = [Math.round(eye.x / 1.5), Math.round(eye.z / 1.5)];
      const cells = new Set(slots.values());
      expect(cells.size).toBe(lattice.slots);
      for (let c = column - 4; c < column + 4; c++) {
        for (let r = row - 4; r < row + 4; r++) expect(cells.has(`${c},${r}`)).toBe(true);
      }
      expect(lattice.update(eye)).toBe(false);
      eye.x += 6 * (random() - 0.5);
      eye.z += 6 * (random() - 0.5);
    }
  });
});

describe("a large lattice", () => {
  it("is filled in several updates, and complete after them even if it was reset on the way", () => {
    const side = 160;
    const slots = new Set<number>();
    const lattice = new Lattice(side, 0.5, (slot) => slots.add(slot));
    const eye = { x: 3, z: -4 };
    expect(lattice.update(eye)).toBe(false);
    lattice.reset();
    slots.clear();
    let updates = 1;
    while (!lattice.update(eye)) updates++;
    expect(updates).toBeGreaterThan(2);
    expect(slots.size).toBe(side * side);
    expect(lattice.update(eye)).toBe(false);
  });
});

describe("pictures of plants", () => {
  const { width, height, pixels } = paintPlants();
  const share = (left: number, holds: (at: number) => boolean) => {
    let sum = 0;
    for (let y = 0; y < height; y++) {
      for (let x = left; x < left + PLANT_SIDE; x++) if (holds(4 * (y * width + x))) sum++;
    }
    return sum / (PLANT_SIDE * height);
  };

  it("leave most of the card transparent and its margin free, and the twig has wood and leaves", () => {
    for (const left of [0, PLANT_SIDE]) {
      const filled = share(left, (at) => pixels[at + 3] === 255);
      expect(filled).toBeGreaterThan(0.08);
      expect(filled).toBeLessThan(0.5);
      for (let y = 0; y < height; y++) {
        expect(pixels[4 * (y * width + left) + 3]).toBe(0);
        expect(pixels[4 * (y * width + left + PLANT_SIDE - 1) + 3]).toBe(0);
      }
    }
    expect(share(0, (at) => pixels[at + 1] > 200)).toBeGreaterThan(0.01);
    expect(share(0, (at) => pixels[at + 3] > 0 && pixels[at + 1] === 0)).toBeGreaterThan(0.1);
  });
});
