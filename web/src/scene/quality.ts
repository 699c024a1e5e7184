/** How much the picture may cost: pixels, shadows, level of detail. */
export type Quality = "low" | "medium" | "high";
