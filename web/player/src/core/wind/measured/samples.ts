/**
 * The samples of a table: times and velocities, as they stand in the file.
 * Twin: precompute/galewood/wind/measured/samples.py.
 */
import { cellAt, isComment, numberOf, quoted, type Row } from "../../files/delimited";
import {
  type Columns,
  columnName,
  columnsOf,
  compass_deg,
  firstValue,
  NO_COLUMNS,
  SPEED_UNITS,
  TIME_UNITS,
  withUnits,
} from "./columns";
import { errorAt, MeasurementError } from "./errors";
import { DAY_S, dateTime_s, isClock, isMonthFirst } from "./times";

const HEADER_WITHIN = 100;
const UNIT_ROWS = 3;
const MOST_ROWS = 2_000_000;
/** Faster values count as missing: loggers write 99.9 or 999 for a fault. */
const FASTEST_M_S = 75;
const EPOCH_MS = 1e11;
const NO_HEADER =
  "no column names were found. Name a column 'time' and 'speed' with 'direction' (or 'u' and 'v'), with units, for example: time (s);speed (m/s);direction (deg)";

/** Times (s) and velocities (m/s, to the east and to the north; NaN if missing), in the file's order. */
export interface Samples {
  readonly columns: Columns;
  readonly time_s: number[];
  readonly east_m_s: number[];
  readonly north_m_s: number[];
  /** Values faster than any wind. */
  implausible: number;
}

/** Reads the rows of a table; throws MeasurementError with line and column. */
export function samplesOf(rows: readonly Row[]): Samples {
  if (rows.length > MOST_ROWS) throw new MeasurementError(`more than ${MOST_ROWS} rows; split the file`);
  const named = header(rows);
  const below = rows.slice(named.first).filter((row) => !isComment(row));
  const { columns, skipped } = skipUnits(named.columns, below);
  const data = below.slice(skipped);
  if (data.length === 0) {
    throw new MeasurementError("there are no rows of numbers below the names of the columns");
  }
  const clock = new Clock(columns, data);
  const samples: Samples = {
    columns: { ...columns, timeUnit: clock.unit },
    time_s: [],
    east_m_s: [],
    north_m_s: [],
    implausible: 0,
  };
  for (const row of data) {
    samples.time_s.push(clock.time_s(row));
    addVelocity(samples, columns, row);
  }
  return samples;
}

/** The columns and the index of the row after their names. */
function header(rows: readonly Row[]): { columns: Columns; first: number } {
  for (const [k, row] of rows.slice(0, HEADER_WITHIN).entries()) {
    const columns = columnsOf(row);
    if (columns) return { columns, first: k + 1 };
  }
  const first = Math.max(
    0,
    rows.findIndex((row) => !isComment(row)),
  );
  const cells = rows[first]?.cells ?? [];
  if (cells.length === 3 && cells.slice(1).every(isNumber)) {
    const names = ["time", "speed", "direction"];
    return { columns: { ...NO_COLUMNS, names, time: 0, speed: 1, direction: 2 }, first };
  }
  throw new MeasurementError(NO_HEADER);
}

/** Whether a cell holds a number that is not missing. */
function isNumber(cell: string): boolean {
  const number = numberOf(cell);
  return number !== null && !Number.isNaN(number);
}

/** The columns with their units, and how many rows of units and statistics lie above the numbers. */
function skipUnits(named: Columns, rows: readonly Row[]): { columns: Columns; skipped: number } {
  let columns = named;
  for (const [k, row] of rows.slice(0, UNIT_ROWS).entries()) {
    const time = cellAt(row, columns.time);
    if (isNumber(cellAt(row, firstValue(columns)))) return { columns, skipped: k };
    if (isNumber(time) || dateTime_s(time) !== null) return { columns, skipped: k };
    columns = withUnits(columns, row);
  }
  return { columns, skipped: Math.min(UNIT_ROWS, rows.length) };
}

/** Reads the times of the rows. */
class Clock {
  readonly unit: string;
  private readonly dated: boolean;
  private readonly numbers: boolean;
  private readonly monthFirst: boolean;
  private readonly daily: boolean;
  private days_s = 0;
  private last_s = Number.NEGATIVE_INFINITY;

  constructor(
    private readonly columns: Columns,
    rows: readonly Row[],
  ) {
    const texts = rows.map((row) => cellAt(row, columns.time));
    this.dated = columns.date >= 0 && isClock(texts[0]);
    const dates = this.dated ? rows.map((row) => cellAt(row, columns.date)) : texts;
    this.numbers = isNumber(texts[0]);
    this.monthFirst = this.numbers || isMonthFirst(dates);
    this.daily = !this.dated && isClock(texts[0]);
    const huge = this.numbers && (numberOf(texts[0]) as number) > EPOCH_MS;
    this.unit = this.numbers ? columns.timeUnit || (huge ? "ms" : "s") : "";
  }

  /** Seconds; NaN if the time is missing. */
  time_s(row: Row): number {
    const cell = cellAt(row, this.columns.time);
    const name = columnName(this.columns, this.columns.time);
    if (this.numbers) {
      const number = numberOf(cell);
      if (number !== null) return number * TIME_UNITS[this.unit][0];
      throw errorAt(row.line, name, `${quoted(cell)} is not a number, as the times above it are`);
    }
    const text = this.dated ? `${cellAt(row, this.columns.date)} ${cell}` : cell;
    if (text.trim() === "") return Number.NaN;
    const time_s = dateTime_s(text, this.monthFirst);
    if (time_s === null) {
      throw errorAt(row.line, name, `${quoted(text)} is not a time such as 2024-05-31T12:00:00.5 or 12.5`);
    }
    return this.daily ? this.pastMidnight(time_s) : time_s;
  }

  private pastMidnight(time_s: number): number {
    if (time_s < this.last_s - DAY_S / 2) this.days_s += DAY_S;
    this.last_s = time_s;
    return time_s + this.days_s;
  }
}

function addVelocity(samples: Samples, columns: Columns, row: Row): void {
  const factor = SPEED_UNITS[columns.speedUnit || "m/s"][0];
  let [east, north] = [0, 0];
  if (columns.speed < 0) {
    [east, north] = [columns.east, columns.north].map((k) => valueAt(columns, row, k) * factor);
  } else {
    const speed = valueAt(columns, row, columns.speed) * factor;
    if (speed < 0) {
      const what = "a wind speed cannot be negative; components are columns 'u' and 'v'";
      throw errorAt(row.line, columnName(columns, columns.speed), what);
    }
    [east, north] = components(speed, columns, row);
  }
  if (Math.hypot(east, north) > FASTEST_M_S) {
    samples.implausible++;
    east = north = Number.NaN;
  }
  samples.east_m_s.push(east);
  samples.north_m_s.push(north);
}

/** Components to the east and north; without a column of directions the wind comes from the west. */
function components(speed: number, columns: Columns, row: Row): [number, number] {
  if (columns.direction < 0) return [speed, 0];
  let angle = directionAt(columns, row);
  if (columns.directionUnit === "deg") angle = (angle * Math.PI) / 180;
  // vanes have no direction in still air
  if (speed === 0 && Number.isNaN(angle)) angle = 0;
  const sign = columns.towards ? 1 : -1;
  return [sign * speed * Math.sin(angle), sign * speed * Math.cos(angle)];
}

function directionAt(columns: Columns, row: Row): number {
  const cell = cellAt(row, columns.direction);
  if (/^\p{L}{1,3}$/u.test(cell) && !["nan", "na", "inf"].includes(cell.toLowerCase())) {
    const angle = compass_deg(cell);
    if (angle !== null) return angle;
    throw errorAt(row.line, columnName(columns, columns.direction), `${quoted(cell)} is not a number`);
  }
  return valueAt(columns, row, columns.direction);
}

function valueAt(columns: Columns, row: Row, column: number): number {
  const cell = cellAt(row, column);
  const number = numberOf(cell);
  if (number === null)
    throw errorAt(row.line, columnName(columns, column), `${quoted(cell)} is not a number`);
  return number;
}
