/** Readers of data files; a file of its own, because few visitors need them. */
export { isInventory, readInventory, textOf } from "galewood/inventory";
export { isMeasurement } from "galewood/measured";
