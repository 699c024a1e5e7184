/**
 * Which column of a table is time, speed, direction or a component, and in which unit.
 * Twin: precompute/galewood/wind/measured/columns.py.
 */
import { cellAt, type Row } from "../../files/delimited";

type Units = Readonly<Record<string, readonly [factor: number, pattern: RegExp]>>;

export const SPEED_UNITS: Units = {
  "m/s": [1, /^(?:m\/s(ec)?|m\/?s-1|mps|ms|met(er|re)s?\/s(ec(ond)?)?|met(er|re)spersecond)$/],
  "km/h": [1 / 3.6, /^(?:km\/?h(r|our)?|km\/?h-1|kph|kmph)$/],
  mph: [0.44704, /^(?:mph|mi\/h|miles\/h(our)?|milesperhour)$/],
  knots: [1852 / 3600, /^(?:kno?ts?|kn|kts?|knoten)$/],
  "ft/s": [0.3048, /^(?:ft\/s(ec)?|fps|feet\/s(ec(ond)?)?)$/],
  "cm/s": [0.01, /^(?:cm\/s(ec)?|cm\/?s-1)$/],
};
export const TIME_UNITS: Units = {
  ms: [1e-3, /^(?:ms|msec|millis(ec(ond)?s?)?)$/],
  s: [1, /^(?:s|secs?|seconds?|sekunden?|epoch|unix|unixtime)$/],
  min: [60, /^(?:min(ute)?s?|minuten)$/],
  h: [3600, /^(?:h|hrs?|hours?|stunden?)$/],
};
const TIME =
  /(?:^| )(time ?stamp|date ?time|time|zeit|zeitpunkt|zeitstempel|messzeit|uhrzeit|t|seconds?|secs?|s|ms|millis(?:econds?)?|epoch|unix ?time|utc|local ?time|elapsed)(?: |$)/;
const DATE = /(?:^| )(date|datum|day|tag)(?: |$)/;
const SPEED =
  /(?:^| )(wind ?speed|wind ?spd|wspd|ws\d*|wind ?vel(?:ocity)?|wind ?geschw[a-z]*|geschwindigkeit|speed|spd|ff|velocity)(?: |$)/;
const DIRECTION =
  /(?:^| )(wind ?dir(?:ection)?|wdir|wd\d*|dir|direction|wind ?richtung|richtung|dd|azimuth|bearing|wind ?from|wind ?heading|heading)(?: |$)/;
const TOWARDS = /(?:^| )(to|towards?|heading|nach)(?: |$)/;
const component = (letter: string, words: string) =>
  new RegExp(
    `^(?:(${letter}|${letter}x|${letter} ?wind|wind ?${letter}|${letter} ?comp(?:onent)?|${words})(?: (?:m/?s|m s|m s 1|mps|avg|mean))*)$`,
  );
const EAST = component("u", "eastward[a-z ]*|east");
const NORTH = component("v", "northward[a-z ]*|north|uy");
const OTHER =
  /(?:^| )(std|sd\d*|stdev|stddev|sigma|max|maximum|min|minimum|gusts?|boe|dev|qc|flag|quality|err|error|var|variance)(?: |$)/;
const POINTS = "N,NNE,NE,ENE,E,ESE,SE,SSE,S,SSW,SW,WSW,W,WNW,NW,NNW".split(",");

/** Indices of the columns (−1: none) and the units of their numbers. */
export interface Columns {
  readonly names: readonly string[];
  readonly time: number;
  readonly date: number;
  readonly speed: number;
  readonly direction: number;
  readonly east: number;
  readonly north: number;
  /** Empty: not stated. */
  readonly speedUnit: string;
  readonly timeUnit: string;
  readonly directionUnit: "deg" | "rad";
  /** Whether the direction is where the wind blows to. */
  readonly towards: boolean;
}

export const NO_COLUMNS: Columns = {
  names: [],
  time: -1,
  date: -1,
  speed: -1,
  direction: -1,
  east: -1,
  north: -1,
  speedUnit: "",
  timeUnit: "",
  directionUnit: "deg",
  towards: false,
};

/** The first of the columns with a velocity. */
export const firstValue = ({ speed, east }: Columns): number => (speed < 0 ? east : speed);

/** Name of a column, or its number. */
export const columnName = ({ names }: Columns, column: number): string => names[column] || String(column + 1);

/** What each column was taken for: its name, with the unit. */
export function understood(columns: Columns): Record<string, string> {
  const speed = columns.speedUnit || "m/s";
  const angle = `${columns.directionUnit === "rad" ? "rad" : "°"} ${columns.towards ? "towards" : "from"}`;
  const taken: [string, number, string][] = [
    ["date", columns.date, ""],
    ["time", columns.time, columns.timeUnit],
    ["speed", columns.speed, speed],
    ["direction", columns.direction, angle],
    ["u", columns.east, speed],
    ["v", columns.north, speed],
  ];
  return Object.fromEntries(
    taken
      .filter(([, column]) => column >= 0)
      .map(([what, column, unit]) => {
        const name = columnName(columns, column);
        return [what, unit ? `${name}: ${unit}` : name];
      }),
  );
}

/** The columns that a row of names describes; null if it is no such row. */
export function columnsOf(row: Row): Columns | null {
  const names = row.cells.map((cell) => cell.replace(/^[#%! /]+/, "").trim());
  const plain = names.map(plainName);
  const first = (pattern: RegExp) => plain.findIndex((name) => !OTHER.test(name) && pattern.test(name));
  let [time, date] = [first(TIME), first(DATE)];
  const [speed, direction] = [first(SPEED), first(DIRECTION)];
  let [east, north] = [first(EAST), first(NORTH)];
  if (time < 0) [time, date] = [date, -1];
  if (speed < 0 && (east < 0 || north < 0)) return null;
  if (time < 0 || time === speed || time === east || time === north) return null;
  if (speed >= 0) east = north = -1;
  const angle = direction < 0 ? "" : names[direction].toLowerCase();
  return {
    names,
    time,
    date: date === time ? -1 : date,
    speed,
    direction,
    east,
    north,
    speedUnit: unitIn(names[speed < 0 ? east : speed], SPEED_UNITS),
    timeUnit: unitIn(names[time], TIME_UNITS),
    directionUnit: /[[(]rad/.test(angle) ? "rad" : "deg",
    towards: direction >= 0 && TOWARDS.test(plain[direction]),
  };
}

/** The columns with the units of a row of units, as far as it states any. */
export function withUnits(columns: Columns, row: Row): Columns {
  const radians = columns.direction >= 0 && cellAt(row, columns.direction).toLowerCase().startsWith("rad");
  return {
    ...columns,
    speedUnit: unitOf(cellAt(row, firstValue(columns)), SPEED_UNITS) || columns.speedUnit,
    timeUnit: unitOf(cellAt(row, columns.time), TIME_UNITS) || columns.timeUnit,
    directionUnit: radians ? "rad" : columns.directionUnit,
  };
}

/** The unit that a text names; empty if it names none. */
function unitOf(text: string, units: Units): string {
  const compact = text
    .toLowerCase()
    .replace(/[\s^*·()[\]]/g, "")
    .replaceAll("−", "-")
    .replaceAll("per", "/");
  return Object.keys(units).find((unit) => units[unit][1].test(compact)) ?? "";
}

/** The angle of a point of the compass (N, NNE, …); null for another text. */
export function compass_deg(cell: string): number | null {
  const index = POINTS.indexOf(cell.toUpperCase().replaceAll("O", "E"));
  return index < 0 ? null : (360 / POINTS.length) * index;
}

/** A name in lower case, without its unit in brackets, words separated by single blanks. */
function plainName(name: string): string {
  const bare = name
    .toLowerCase()
    .replace(/[[(].*?[\])]/g, " ")
    .replaceAll("ö", "oe");
  return bare.replace(/[^a-z0-9/]+/g, " ").trim();
}

/** The unit in the brackets of a name, or among its words. */
function unitIn(name: string, units: Units): string {
  for (const [, bracket] of name.matchAll(/[[(](.*?)[\])]/g)) {
    const unit = unitOf(bracket, units);
    if (unit) return unit;
  }
  const words = plainName(name).split(" ");
  const pairs = words.slice(1).map((word, k) => `${words[k]}/${word}`);
  for (const text of [...pairs, ...words]) {
    const unit = unitOf(text, units);
    if (unit) return unit;
  }
  return "";
}
