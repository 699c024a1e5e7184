/**
 * What the reader of a measurement assumed, left out or changed, in sentences.
 * Twin: precompute/galewood/wind/measured/notes.py.
 */
import type { Columns } from "./columns";
import type { Report } from "./report";

const SLOW_HZ = 0.99;

/** The sentences, the most important first. */
export const notesOf = (report: Omit<Report, "notes">, columns: Columns): string[] => [
  ...aboutPart(report),
  ...aboutColumns(columns),
  ...aboutFaults(report),
];

function* aboutPart(report: Omit<Report, "notes">): Generator<string> {
  if (report.used_s < report.duration_s - 1.5 / report.used_rate_hz) {
    yield `Of ${duration(report.duration_s)}, ${duration(report.used_s)} are used, from ${duration(report.used_start_s)} after the first sample.`;
  }
  if (report.used_rate_hz < 0.98 * report.rate_hz) {
    yield `Averaged from ${report.rate_hz.toFixed(1)} Hz to ${report.used_rate_hz.toFixed(1)} Hz.`;
  }
  if (report.rate_hz < SLOW_HZ) {
    yield `One sample every ${duration(1 / report.rate_hz)}: faster gusts, which make trees sway, are not in the measurement.`;
  }
  yield `The wind repeats after ${duration(report.loop_s)}; its last ${duration(report.loop_s - report.used_s)} lead from the end back to the beginning.`;
}

function* aboutColumns(columns: Columns): Generator<string> {
  if (!columns.speedUnit) yield "No unit of the speed was found: m/s is assumed.";
  if (columns.speed < 0) yield "u is taken as the component to the east, v as that to the north.";
  else if (columns.direction < 0) yield "There is no direction: the wind is assumed to come from the west.";
  else if (columns.towards) yield "The direction is taken as where the wind blows to, as its name says.";
}

function* aboutFaults(report: Omit<Report, "notes">): Generator<string> {
  if (report.gaps > 0) {
    yield `${counted(report.gaps, "gap")} (the longest ${duration(report.longest_gap_s)}); gaps of up to a minute are interpolated linearly, longer ones end the part that is used.`;
  }
  if (report.missing > 0) yield `${counted(report.missing, "row")} without time or wind, ignored.`;
  if (report.implausible > 0) yield `${counted(report.implausible, "value")} above 75 m/s, taken as missing.`;
  if (report.duplicates > 0) {
    yield `${counted(report.duplicates, "row")} with the time of another one, ignored.`;
  }
  if (report.disordered > 0) yield `${counted(report.disordered, "row")} out of order, sorted by time.`;
}

const counted = (count: number, what: string): string => `${count} ${what}${count === 1 ? "" : "s"}`;

/** A duration in words: 0.4 s, 9 min 55 s, 2 h 5 min. */
export function duration(seconds: number): string {
  if (seconds < 59.95) return `${seconds.toFixed(1)} s`;
  const whole = Math.floor(seconds + 0.5);
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  return hours > 0 ? `${hours} h ${minutes} min` : `${minutes} min ${whole % 60} s`;
}
