/** How an uploaded tree is expected to move, read from its import report, and how stiff it is to be. Pure. */
import { LINEAR_SWAY_SHARE } from "../../constants";

export interface Sway {
  readonly wind_m_s: number;
  readonly sway_m: number;
  readonly share: number;
}

export interface ExpectedMotion {
  readonly first_Hz: number;
  /** At most as stiff as measured trees of this height, and visible in strong wind. */
  readonly lively_Hz: number;
  /** What the service makes of it unless it is asked for something else: one of the two above. */
  readonly default_Hz: number;
  readonly sways: readonly Sway[];
  /** Whether its motion is visible with the stiffness of its wood. */
  readonly visible: boolean;
}

type Json = Record<string, unknown>;
const object = (value: unknown): Json => (typeof value === "object" && value !== null ? (value as Json) : {});
const isNumber = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);

function swayOf(value: unknown): Sway[] {
  const { wind_m_s, sway_m, share } = object(value);
  return isNumber(wind_m_s) && isNumber(sway_m) && isNumber(share) ? [{ wind_m_s, sway_m, share }] : [];
}

/** The expectation in an import report; null if the server could not make one. */
export function expectedMotionOf(report: unknown): ExpectedMotion | null {
  const all = object(report);
  const found = "up_axis" in all ? all : object(all.import);
  const { first_frequency_hz, lively_frequency_hz, default_frequency_hz, sway, visible } = object(
    found.expected,
  );
  if (!isNumber(first_frequency_hz) || !isNumber(lively_frequency_hz)) return null;
  return {
    first_Hz: first_frequency_hz,
    lively_Hz: lively_frequency_hz,
    default_Hz: isNumber(default_frequency_hz) ? default_frequency_hz : first_frequency_hz,
    sways: Array.isArray(sway) ? sway.flatMap(swayOf) : [],
    visible: visible === true,
  };
}

/** Whether there is room between the stiffness of the wood and a livelier one. */
export const isAdjustable = ({ first_Hz, lively_Hz }: ExpectedMotion): boolean => lively_Hz < first_Hz;

/** The liveliness that the service chooses. */
export const defaultLiveliness = ({ first_Hz, default_Hz }: ExpectedMotion): number =>
  default_Hz < first_Hz ? 1 : 0;

/** First frequency at a liveliness from 0, as stiff as its wood, to 1. */
export const frequency_Hz = ({ first_Hz, lively_Hz }: ExpectedMotion, liveliness: number): number =>
  first_Hz * (lively_Hz / first_Hz) ** liveliness;

/** The sways at this liveliness: they follow the reciprocal of the stiffness. */
export function swaysAt(expected: ExpectedMotion, liveliness: number): Sway[] {
  const softer = (expected.first_Hz / frequency_Hz(expected, liveliness)) ** 2;
  return expected.sways.map(({ wind_m_s, sway_m, share }) => ({
    wind_m_s,
    sway_m: sway_m * softer,
    share: share * softer,
  }));
}

/** A length to read. */
export function lengthInWords(length_m: number): string {
  if (length_m >= 1) return `${length_m.toFixed(1)} m`;
  if (length_m >= 0.0095) return `${Math.round(100 * length_m)} cm`;
  return length_m >= 0.0001 ? `${Number((1000 * length_m).toPrecision(1))} mm` : "less than 0.1 mm";
}

/** The sways as one sentence. */
export function swaysInWords(sways: readonly Sway[]): string {
  const each = sways.map(({ wind_m_s, sway_m, share }) => {
    if (share > LINEAR_SWAY_SHARE)
      return `more than ${100 * LINEAR_SWAY_SHARE} % of its height at ${wind_m_s} m/s`;
    const percent =
      share >= 1e-5 ? String(Number((100 * share).toPrecision(share < 0.1 ? 1 : 2))) : "less than 0.001";
    return `${lengthInWords(sway_m)} (${percent} % of its height) at ${wind_m_s} m/s`;
  });
  return each.join(", ");
}
