/** Modules that the build makes. */
declare module "virtual:worker" {
  /** Source of the worker, in one piece. */
  const source: string;
  export default source;
}
