import { describe, expect, test } from "vitest";
import { LONGEST_LINK } from "../../../../web/player/src/core/constants";
import { NodePose, turn } from "../../../../web/player/src/core/motion/nodePose";
import { decodeTable } from "../../../../web/player/src/core/table/table";
import { tableMotion } from "../../../../web/player/src/worker/table/tableMotion";
import { golden } from "../../golden";
import { seededRandom } from "../../seeded";

interface Drawn {
  q: number[];
  factor: number;
  rest_m: number[][];
  drawn_m: number[][];
}

const motion = tableMotion("", decodeTable(golden("pole-table.safetensors")), 0);

describe("the drawn vertices", () => {
  test("are those of Python, also where links are shortened", () => {
    const rows = JSON.parse(new TextDecoder().decode(golden("drawn.json"))) as Drawn[];
    const out = new Float64Array(3);
    for (const { q, factor, rest_m, drawn_m } of rows) {
      const pose = new NodePose(motion).take(q, 0, factor);
      rest_m.forEach(([x, y, z], vertex) => {
        pose.place(vertex, x, y, z, out);
        for (let axis = 0; axis < 3; axis++) expect(out[axis]).toBeCloseTo(drawn_m[vertex][axis], 4);
      });
    }
  });

  test("are at rest in the pose zero", () => {
    const out = new Float64Array(3);
    new NodePose(motion).take(null).place(3, 0.2, 1.7, -0.1, out);
    [0.2, 1.7, -0.1].forEach((value, axis) => {
      expect(out[axis]).toBeCloseTo(value, 6);
    });
  });

  test("keep all links between nodes shorter than the limit", () => {
    const random = seededRandom(3);
    const { parent, rest_m, nodes } = motion;
    for (let round = 0; round < 20; round++) {
      const q = Float32Array.from({ length: motion.modes }, () => 4 * (random() - 0.5));
      const { moved } = new NodePose(motion).take(q);
      for (let node = 0; node < nodes; node++) {
        const before = parent[node];
        const link = [0, 1, 2].map((axis) => rest_m[3 * node + axis] - rest_m[3 * before + axis]);
        const now = link.map((length, axis) => length + moved[3 * node + axis] - moved[3 * before + axis]);
        expect(Math.hypot(...now)).toBeLessThanOrEqual(LONGEST_LINK * Math.hypot(...link) + 1e-5);
      }
    }
  });
});

describe("turning an arm", () => {
  test("keeps its length and turns it about the vector", () => {
    const random = seededRandom(5);
    const out = new Float64Array(3);
    for (let round = 0; round < 200; round++) {
      const [x, y, z, a, b, c] = Array.from({ length: 6 }, () => 4 * (random() - 0.5));
      turn(x, y, z, a, b, c, out);
      expect(Math.hypot(...out)).toBeCloseTo(Math.hypot(x, y, z), 9);
      expect(out[0] * a + out[1] * b + out[2] * c).toBeCloseTo(x * a + y * b + z * c, 9);
    }
  });

  test("by a small vector is the cross product, and by a large one less than a quarter turn", () => {
    const out = new Float64Array(3);
    turn(1, 0, 0, 0, 0, 1e-3, out);
    expect([...out]).toEqual([expect.closeTo(1, 5), expect.closeTo(1e-3, 9), 0]);
    turn(1, 0, 0, 0, 0, 50, out);
    expect(out[0]).toBeGreaterThan(0);
    expect(out[1]).toBeLessThan(1);
  });
});
