/** Render quality: resolution, shadows, level of detail. */
export type Quality = "low" | "medium" | "high";
