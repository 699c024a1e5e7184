/**
 * The generator, importable in Node: on import it loads its own bark and leaf pictures through
 * `document`, which we never use, so a stub that swallows the request is enough.
 */
const stub = { createElementNS: () => ({ addEventListener() {}, removeEventListener() {} }) };
const scope = globalThis as unknown as { document?: unknown };
scope.document ??= stub;

export const { Tree, TreePreset } = await import("@dgreenheck/ez-tree");
