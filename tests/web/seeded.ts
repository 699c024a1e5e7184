import { random } from "./golden";

/** A seeded stream of numbers in [0, 1); prints its seed, so that a failure can be repeated. */
export function seededRandom(seed: number): () => number {
  console.log(`seed ${seed}`);
  return random(seed);
}
