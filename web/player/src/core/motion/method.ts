/** How poses are computed from a table. */

/** The modal reduced-order model, or the record search of the paper. */
export type Method = "modal" | "paper";

export const METHODS: readonly Method[] = ["modal", "paper"];

/** The method with this id; null for an unknown one. */
export const parseMethod = (id: unknown): Method | null => METHODS.find((method) => method === id) ?? null;
