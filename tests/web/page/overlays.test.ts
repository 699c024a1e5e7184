/** What the overlays compute: binding to nodes, edges, frequencies, local errors. */
import { expect, test } from "vitest";
import { localError_m } from "../../../web/src/page/overlays/localError";
import { edgesOf, linksOf } from "../../../web/src/page/overlays/structure";
import { modesByFrequency } from "../../../web/src/page/overlays/modes";
import { NodeBinding } from "../../../web/src/scene/overlays/nodeBinding";
import { oscillatorFrequencies_hz } from "../../../web/player/src/worker/table/oscillators";
import { random } from "../golden";

test("points move as their nodes do: exactly at a node, as all of them in a translation, not at the root (seed 4)", () => {
  const next = random(4);
  const rest = Float32Array.from({ length: 60 }, (_, i) => (i % 3 === 1 ? 2 + 8 * next() : next()));
  const points = Float32Array.of(...rest.subarray(0, 3), 0.3, 7, 0.4, 0, 0, 0);
  const binding = new NodeBinding(points, rest);
  const out = new Float32Array(9);
  const moved = Float32Array.from(rest, () => next());
  binding.displace(moved, out);
  for (let axis = 0; axis < 3; axis++) expect(out[axis]).toBeCloseTo(moved[axis], 3);
  binding.displace(rest.map((_, i) => [1, -2, 3][i % 3]), out);
  [1, -2, 3].forEach((by, axis) => expect(out[3 + axis]).toBeCloseTo(by, 5));
  expect([...out.subarray(6)].map(Math.abs)).toEqual([0, 0, 0]);
});

test("two tetrahedra with a common face have nine edges, each once", () => {
  const edges = edgesOf([[0, 1, 2, 3], [3, 2, 1, 4]], 5);
  const pairs = Array.from({ length: edges.length / 2 }, (_, k) => `${edges[2 * k]}-${edges[2 * k + 1]}`);
  expect(pairs.sort()).toEqual(["0-1", "0-2", "0-3", "1-2", "1-3", "1-4", "2-3", "2-4", "3-4"]);
  expect([...linksOf([-1, 0, 1, 1])]).toEqual([0, 1, 1, 2, 1, 3]);
});

test("the frequencies are those of the exact solution of a damped oscillator", () => {
  const dt_s = 1 / 30;
  const cases = [[0.3, 0.03], [1.7, 0.1], [6, 0.02]];
  const rows = cases.flatMap(([hz, damping]) => {
    const omega = 2 * Math.PI * hz;
    const [decay, damped] = [damping * omega, omega * Math.sqrt(1 - damping ** 2)];
    const [e, c, s] = [Math.exp(-decay * dt_s), Math.cos(damped * dt_s), Math.sin(damped * dt_s)];
    const r00 = e * (c + (decay / damped) * s);
    const r11 = e * (c - (decay / damped) * s);
    return [r00 - 1, (e * s) / damped, (-e * omega * omega * s) / damped, r11 - 1, 0, 0];
  });
  const found = oscillatorFrequencies_hz(Float32Array.from(rows), dt_s);
  cases.forEach(([hz, damping], k) => expect(found[k] / (hz * Math.sqrt(1 - damping ** 2))).toBeCloseTo(1, 3));
  expect(modesByFrequency({ frequencies_hz: Float32Array.of(3, 1, 2) })).toEqual([1, 2, 0]);
});

test("the local error is the root mean square distance of a node from the reference", () => {
  // two nodes: the first moves along x with coordinate 0, the second along z with coordinate 1
  const basis = new Float32Array(2 * 3 * 4);
  basis[0] = 1;
  basis[5 * 4 + 1] = 2;
  const motion = { basis, stride: 4, nodes: 2 };
  const q = { fem: Float32Array.of(0, 0, 0, 0), modal: Float32Array.of(3, 1, 4, 0), paper: null };
  const error = localError_m(motion as never, { q, modes: 2, frames: 2 } as never);
  expect(error[0]).toBeCloseTo(Math.sqrt((9 + 16) / 2), 6);
  expect(error[1]).toBeCloseTo(Math.sqrt(4 / 2), 6);
});
