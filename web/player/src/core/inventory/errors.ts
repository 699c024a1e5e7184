/** A file that is no usable inventory: what is wrong and what to do. */
export class InventoryError extends Error {
  override readonly name = "InventoryError";
}

/** Why a row describes no tree. */
export class NoTree extends Error {}
