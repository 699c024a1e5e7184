/** Render quality: resolution, shadows, level of detail. */
export type Quality = "low" | "medium" | "high";

/** Whether the edges of a picture are smoothed. */
export const isAntialiased = (quality: Quality): boolean => quality !== "low";
