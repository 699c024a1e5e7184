/** How poses are computed from a table. */

/** The modal reduced-order model, or the record search of the paper. */
export type Method = "modal" | "paper";

export const METHODS: readonly Method[] = ["modal", "paper"];

/** Former id of the modal method: still accepted wherever a method is read, never written. */
const FORMER_MODAL_ID = "tangent";

/** The method with this id; null for an unknown one. */
export function parseMethod(id: unknown): Method | null {
  if (id === FORMER_MODAL_ID) return "modal";
  return METHODS.find((method) => method === id) ?? null;
}

/** The entry of a record keyed by method, under the present id or the former one. */
export function entryOfMethod<T>(entries: Readonly<Record<string, T>>, method: Method): T | undefined {
  return method in entries || method !== "modal" ? entries[method] : entries[FORMER_MODAL_ID];
}
