/** The natural modes of a table: order, rate and words. Pure. */
import type { TableMotion } from "galewood/client";

/** Faster modes are slowed down to this. */
const FASTEST_SHOWN_HZ = 0.8;

/** Frequency at which a mode is shown, Hz. */
export const shownFrequency_hz = (frequency_hz: number): number => Math.min(frequency_hz, FASTEST_SHOWN_HZ);

/** The coordinates of a table's natural modes, by frequency. */
export const modesByFrequency = ({ frequencies_hz }: Pick<TableMotion, "frequencies_hz">): number[] =>
  Array.from(frequencies_hz, (_, k) => k).sort((a, b) => frequencies_hz[a] - frequencies_hz[b]);

/** "Mode 2 of 32: 0.98 Hz, shown 1.2 times slower; exaggerated." */
export function modeWords(motion: Pick<TableMotion, "frequencies_hz">, mode: number): string {
  const order = modesByFrequency(motion);
  const hz = motion.frequencies_hz[mode];
  const slower = hz / shownFrequency_hz(hz);
  const rate = slower > 1.05 ? `, shown ${slower.toFixed(1)} times slower` : "";
  return `Mode ${order.indexOf(mode) + 1} of ${order.length}: ${hz.toFixed(2)} Hz${rate}; exaggerated.`;
}
