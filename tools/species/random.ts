/** Seeded random numbers; equal seeds give equal trees on every machine. */
export interface Random {
  /** Uniform in [low, high). */
  uniform(low: number, high: number): number;
  /** Uniform in [centre - spread, centre + spread). */
  around(centre: number, spread: number): number;
  integer(count: number): number;
}

/** mulberry32 (public domain, Tommy Ettinger): 32 bits of state, exact integer arithmetic. */
export function seededRandom(seed: number): Random {
  let state = seed >>> 0;
  const next = (): number => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
  const uniform = (low: number, high: number): number => low + (high - low) * next();
  return {
    uniform,
    around: (centre, spread) => uniform(centre - spread, centre + spread),
    integer: (count) => Math.floor(next() * count),
  };
}
