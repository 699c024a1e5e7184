/** Forests from inventories: documents of stems, each with a place, a species and a height. */
export { type Inventory, InventoryError, type Report, readInventory, type Stem } from "./inventory/document";
export { placesOf, SCALES } from "./inventory/places";
export { plantInventory } from "./inventory/plant";
