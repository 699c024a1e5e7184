import type { BufferAttribute } from "three";

/** Mean of the colours of a part; null without any. */
export function meanColour(colour: BufferAttribute | null): [number, number, number] | null {
  if (!colour || colour.count === 0) return null;
  const sum: [number, number, number] = [0, 0, 0];
  for (let i = 0; i < 3 * colour.count; i++) sum[i % 3] += colour.array[i];
  return [sum[0] / colour.count, sum[1] / colour.count, sum[2] / colour.count];
}
