/** Mean of the colours of a part, 3 numbers per vertex; null without any. */
export function meanColour(colours: ArrayLike<number> | null): [number, number, number] | null {
  if (!colours || colours.length === 0) return null;
  const sum: [number, number, number] = [0, 0, 0];
  for (let i = 0; i < colours.length; i++) sum[i % 3] += colours[i];
  const count = colours.length / 3;
  return [sum[0] / count, sum[1] / count, sum[2] / count];
}
