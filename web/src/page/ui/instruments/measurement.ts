/** Loads the file of an anemometer's logger as the wind, and says what was understood of it. */

import {
  duration,
  type Measurement,
  MeasurementError,
  type Report,
  type Row,
  readMeasurement,
  readRows,
} from "galewood/measured";
import type { WindDocument } from "galewood/wind";
import { make } from "../dom";
import { showReport } from "../reportDialog";

const LARGEST_BYTES = 64 * 1024 ** 2;

export interface MeasurementEvents {
  wind(wind: WindDocument): void;
  problem(title: string, hint: string): void;
}

/** Reads the file; the wind starts at once, and the report appears. */
export async function loadMeasurement(file: File, events: MeasurementEvents): Promise<void> {
  try {
    if (file.size > LARGEST_BYTES) throw new MeasurementError("The file is larger than 64 MB. Split the file.");
    const rows = readRows(await file.arrayBuffer());
    use(file.name, rows, 0, events);
  } catch (error) {
    refuse(error, events);
  }
}

function refuse(error: unknown, events: MeasurementEvents): void {
  if (!(error instanceof MeasurementError)) throw error;
  const { message } = error;
  events.problem("The measurement could not be read.", `${message[0].toUpperCase()}${message.slice(1)}.`);
}

function use(name: string, rows: readonly Row[], start_s: number, events: MeasurementEvents): void {
  const found = readMeasurement(rows, start_s);
  events.wind(found.wind);
  const close = showReport({
    heading: "Measured wind",
    file: name,
    figures: figuresOf(found.report),
    notes: found.report.notes,
    control: partChoice(found, (chosen_s) => {
      try {
        close();
        use(name, rows, chosen_s, events);
      } catch (error) {
        refuse(error, events);
      }
    }),
  });
}

const figuresOf = (report: Report): [string, string][] => [
  ...Object.entries(report.columns).map(([what, column]): [string, string] => [`Column for ${what}`, column]),
  ["Samples", `${report.rows} in ${duration(report.duration_s)}, ${rate(report.rate_hz)}`],
  ["Mean wind", `${report.mean_speed_m_s.toFixed(1)} m/s from ${report.from_deg.toFixed(0)}°`],
  ["Strongest sample", `${report.max_speed_m_s.toFixed(1)} m/s`],
  ["Turbulence intensity", `${(100 * report.intensity).toFixed(0)} %`],
  ["Gaps", report.gaps === 0 ? "none" : `${report.gaps}, the longest ${duration(report.longest_gap_s)}`],
];

const rate = (hz: number): string => (hz >= 0.99 ? `${hz.toFixed(1)} Hz` : `one every ${duration(1 / hz)}`);

/** Chooses the part of a long measurement; nothing if all of it is used. */
function partChoice({ report }: Measurement, choose: (start_s: number) => void): HTMLElement | undefined {
  const spare_s = report.duration_s - report.used_s;
  if (spare_s < 60 || report.gaps > 0) return undefined;
  const label = make("label", "Begin after (minutes) ");
  const input = make("input");
  Object.assign(input, { type: "number", min: 0, max: Math.floor(spare_s / 60), step: 1 });
  input.value = String(Math.round(report.used_start_s / 60));
  input.addEventListener("change", () => choose(60 * Number(input.value)));
  label.append(input);
  return label;
}
