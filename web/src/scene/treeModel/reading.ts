/** What the page and the worker that reads trees say to each other. Pure. */
import { type ReadTree, readTree, type TreeKind, type TreeMesh } from "./treeArrays";

/** A tree to read. */
export interface ReadOrder {
  readonly number: number;
  readonly meshes: readonly TreeMesh[];
  readonly kind: TreeKind;
}

/** What was read, or why it could not be. */
export type ReadReply =
  | { readonly number: number; readonly tree: ReadTree }
  | { readonly number: number; readonly tree: null; readonly fault: string };

/** Carries out an order. */
export function answer({ number, meshes, kind }: ReadOrder): ReadReply {
  try {
    return { number, tree: readTree(meshes, kind) };
  } catch (error) {
    return { number, tree: null, fault: error instanceof Error ? error.message : String(error) };
  }
}

/** The buffers of all arrays in a message, which can be handed over instead of copied. */
export function buffersIn(message: unknown, found = new Set<ArrayBuffer>()): Set<ArrayBuffer> {
  if (ArrayBuffer.isView(message)) found.add(message.buffer as ArrayBuffer);
  else if (message !== null && typeof message === "object")
    for (const part of Object.values(message)) buffersIn(part, found);
  return found;
}
