import { describe, expect, it } from "vitest";
import { hashUnit } from "../../../web/player/src/core/math/random";
import { paintGrass, paintLitter, paintNoise } from "../../../web/src/scene/textures/paint";

/** Reference implementation of the noise, which hashes every corner. */
function noise(x: number, y: number, coarsest: number, seed: number): number {
  const smooth = (t: number) => t * t * (3 - 2 * t);
  let sum = 0;
  for (let k = 0; k < 4; k++) {
    const cells = coarsest * 2 ** k;
    const [ix, iy] = [Math.floor(x * cells), Math.floor(y * cells)];
    const [u, v] = [smooth(x * cells - ix), smooth(y * cells - iy)];
    const at = (dx: number, dy: number) => hashUnit(seed + k, (ix + dx) % cells, (iy + dy) % cells);
    const near = at(0, 0) * (1 - u) + at(1, 0) * u;
    sum += 2 ** -k * (near * (1 - v) + (at(0, 1) * (1 - u) + at(1, 1) * u) * v);
  }
  return Math.min(1, Math.max(0, (sum / 1.875 - 0.5) * 1.5 + 0.5));
}

describe("procedural pictures", () => {
  it("use the noise of the reference implementation", () => {
    const side = 96;
    const { pixels } = paintNoise(side);
    for (let i = 0; i < side * side; i += 7) {
      const [x, y] = [(i % side) / side, Math.floor(i / side) / side];
      for (let c = 0; c < 4; c++) {
        const value = Math.round(255 * noise(x, y, c === 3 ? 4 : 8, 100 * c + 7));
        expect(pixels[4 * i + c]).toBe(value);
      }
    }
  });

  it("have no seam: neighbours across the edge differ no more than others", () => {
    const side = 128;
    const { pixels } = paintNoise(side);
    const step = (from: number, to: number) => Math.abs(pixels[4 * from] - pixels[4 * to]);
    let largest = 0;
    let seam = 0;
    for (let y = 0; y < side; y++) {
      for (let x = 1; x < side; x++) largest = Math.max(largest, step(y * side + x - 1, y * side + x));
      seam = Math.max(seam, step(y * side + side - 1, y * side));
    }
    expect(seam).toBeLessThanOrEqual(largest);
  });

  it("cover every pixel and are reproducible", () => {
    for (const paint of [paintLitter, paintGrass]) {
      const { pixels } = paint(64);
      expect(pixels.every((byte, i) => i % 4 !== 3 || byte === 255)).toBe(true);
      expect(paint(64).pixels).toEqual(pixels);
    }
  });
});
