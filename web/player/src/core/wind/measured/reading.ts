/** From the rows of a logger's file to a wind. Twin: precompute/galewood/wind/measured/reading.py. */
import type { Row } from "../../files/delimited";
import type { WindDocument } from "../document";
import { gustSpeed_m_s } from "../edit";
import { TURBULENCE_PER_GUSTINESS } from "../frame";
import { MOST_SAMPLES, quantised } from "../recording";
import { understood } from "./columns";
import { MeasurementError } from "./errors";
import { notesOf } from "./notes";
import type { Report } from "./report";
import { type Samples, samplesOf } from "./samples";
import { type Found, type Series, seriesOf } from "./series";

export { MeasurementError } from "./errors";
export { duration } from "./notes";
export type { Report } from "./report";

/** Length of the passage that leads from the end back to the beginning. */
const CLOSING_S = 5;
const FASTEST_MEAN_M_S = 60;
const LONGEST_INTERVAL_S = 3600;

export interface Measurement {
  readonly wind: WindDocument;
  readonly report: Report;
}

/** Reads a measurement, at most ten minutes at 10 Hz from `start_s` after the first sample. MeasurementError. */
export function readMeasurement(rows: readonly Row[], start_s = 0): Measurement {
  const samples = samplesOf(rows);
  const { series, found } = seriesOf(samples);
  if (series.interval_s > LONGEST_INTERVAL_S) {
    throw new MeasurementError("the samples are more than an hour apart: too far to contain gusts");
  }
  const first = Math.floor(Math.max(start_s, 0) / series.interval_s + 0.5);
  const last = first + MOST_SAMPLES - closing(MOST_SAMPLES, series.interval_s);
  const used: Series = {
    interval_s: series.interval_s,
    east_m_s: series.east_m_s.slice(first, last),
    north_m_s: series.north_m_s.slice(first, last),
  };
  if (used.east_m_s.length < 2) {
    throw new MeasurementError(`the series ends before ${start_s} s; choose an earlier start`);
  }
  return measurementOf(samples, found, used, first);
}

/** Number of samples of the passage from the end to the beginning. */
const closing = (count: number, interval_s: number): number =>
  Math.max(1, Math.min(Math.floor(CLOSING_S / interval_s + 0.5), Math.floor(count / 4)));

const sumOf = (values: readonly number[]): number => values.reduce((sum, value) => sum + value, 0);
const degrees = (radians: number): number => (radians * 180) / Math.PI;

function measurementOf(samples: Samples, found: Found, used: Series, first: number): Measurement {
  const count = used.east_m_s.length;
  const speeds = used.east_m_s.map((u, k) => Math.sqrt(u * u + used.north_m_s[k] * used.north_m_s[k]));
  const mean = sumOf(speeds) / count;
  if (mean > FASTEST_MEAN_M_S) {
    throw new MeasurementError(`the mean speed is ${mean.toFixed(0)} m/s; check the unit of the speed`);
  }
  const east = sumOf(used.east_m_s) / count;
  const north = sumOf(used.north_m_s) / count;
  const heading = Math.atan2(-north, east); // towards, from x (east) to z (south)
  const spread = Math.sqrt(sumOf(speeds.map((speed) => (speed - mean) * (speed - mean))) / count);
  const intensity = mean > 0 ? spread / mean : 0;
  const gustiness = Math.min(Math.max(intensity / TURBULENCE_PER_GUSTINESS, 0.01), 1);
  const values = fluctuations(used, heading, mean, TURBULENCE_PER_GUSTINESS * gustiness * mean);
  addPassage(values, closing(count, used.interval_s));
  const wind: WindDocument = {
    version: 1,
    model: "recorded",
    mean_speed_m_s: mean,
    direction_deg: degrees(heading),
    gustiness,
    convection_speed_m_s: gustSpeed_m_s(mean),
    seed: 1,
    recording: quantised(values, used.interval_s),
  };
  const report = {
    columns: understood(samples.columns),
    rows: found.rows,
    missing: found.missing,
    implausible: samples.implausible,
    duplicates: found.duplicates,
    disordered: found.disordered,
    gaps: found.gaps,
    longest_gap_s: found.longestGap_s,
    rate_hz: 1 / found.interval_s,
    duration_s: found.duration_s,
    used_rate_hz: 1 / used.interval_s,
    used_start_s: found.pieceStart_s + first * used.interval_s,
    used_s: count * used.interval_s,
    loop_s: (values.length / 2) * used.interval_s,
    mean_speed_m_s: mean,
    max_speed_m_s: speeds.reduce((most, speed) => Math.max(most, speed), 0),
    from_deg: (degrees(heading) + 630) % 360,
    intensity,
  };
  return { wind, report: { ...report, notes: notesOf(report, samples.columns) } };
}

/** [count, 2] fluctuations along and across the mean wind, in standard deviations. */
function fluctuations(used: Series, heading: number, mean: number, deviation_m_s: number): number[] {
  const c = Math.cos(heading);
  const s = Math.sin(heading);
  return used.east_m_s.flatMap((u, k) => {
    const v = used.north_m_s[k];
    return deviation_m_s === 0
      ? [0, 0]
      : [(c * u - s * v - mean) / deviation_m_s, (-c * v - s * u) / deviation_m_s];
  });
}

/**
 * Appends a passage in which the mirrored end fades into the mirrored beginning. The weights keep the variance of
 * fluctuations that do not depend on each other.
 */
function addPassage(values: number[], count: number): void {
  const length = values.length / 2;
  for (let k = 0; k < count; k++) {
    const share = (k + 1) / (count + 1);
    const [w, v] = [Math.sqrt(1 - share), Math.sqrt(share)];
    const [old, fresh] = [2 * (length - 1 - k), 2 * (count - k)];
    for (const side of [0, 1]) values.push(w * values[old + side] + v * values[fresh + side]);
  }
}
