/**
 * Makes the generator importable in Node: on import it loads its bark and leaf pictures through `document`. They are
 * not used here, so a stub is sufficient. A bundle takes the sources of the generator instead (bundle-sources.ts).
 */
const stub = { createElementNS: () => ({ addEventListener() {}, removeEventListener() {} }) };
const scope = globalThis as unknown as { document?: unknown };
scope.document ??= stub;

export const { Tree, TreePreset } = await import("@dgreenheck/ez-tree");
