/** Seeded hashes and smooth noise: the same seed gives the same forest on every machine. */
export { fractalNoise, valueNoise } from "./core/math/noise";
export { hash32, hashText, hashUnit } from "./core/math/random";
