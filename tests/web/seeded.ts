import { random } from "./golden";

/** Seeded random numbers in [0, 1); prints the seed, so that a failure can be reproduced. */
export function seededRandom(seed: number): () => number {
  console.log(`seed ${seed}`);
  return random(seed);
}
