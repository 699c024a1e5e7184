/** Says in the forest that its motion is exaggerated. */
import { element } from "../ui/dom";

export function showExaggeration(factor: number): void {
  const badge = element("exaggerated");
  badge.hidden = factor <= 1;
  const words = factor <= 1 ? "" : `Motion exaggerated ×${Number(factor.toFixed(1))}`;
  if (badge.textContent !== words) badge.textContent = words;
}
