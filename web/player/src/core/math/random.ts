/** Small seeded generators: the same seed gives the same forest on every machine. */

/** A well-mixed 32-bit hash of one 32-bit integer. */
export function hash32(value: number): number {
  let h = value | 0;
  h = Math.imul(h ^ (h >>> 16), 0x7feb352d);
  h = Math.imul(h ^ (h >>> 15), 0x846ca68b);
  return (h ^ (h >>> 16)) >>> 0;
}

/** A hash of several integers, uniform in [0, 1). */
export function hashUnit(...values: number[]): number {
  let h = 0x9e3779b9;
  for (const value of values) h = hash32(h ^ hash32(value + 0x632be5ab));
  return h / 4294967296;
}

/** FNV-1a hash of a string; gives every species its own seed. */
export function hashText(text: string): number {
  let h = 0x811c9dc5;
  for (let i = 0; i < text.length; i++) h = Math.imul(h ^ text.charCodeAt(i), 0x01000193);
  return h >>> 0;
}
