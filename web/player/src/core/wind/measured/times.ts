/** Times as loggers write them, in seconds from an arbitrary origin. Twin: precompute/galewood/wind/measured/times.py. */

const CLOCK = String.raw`(\d{1,2}):(\d{2})(?::(\d{2})(?:[.,](\d{1,9}))?)?(?: ?([AP])M)?`;
const ZONE = String.raw`(?: ?(Z|UTC|GMT|[+-]\d{2}(?::?\d{2})?))?`;
const dated = (date: string) => new RegExp(`^${date}(?:[T ]+${CLOCK})?${ZONE}$`, "i");
const YEAR_FIRST = dated(String.raw`(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})`);
const DAY_FIRST = dated(String.raw`(\d{1,2})\.(\d{1,2})\.(\d{4})`);
const SLASHES = dated(String.raw`(\d{1,2})[-/](\d{1,2})[-/](\d{4})`);
const TIME_OF_DAY = new RegExp(`^${CLOCK}$`, "i");
export const DAY_S = 86_400;

type Parts = readonly (string | undefined)[];

/** Whether a text is a time of day without a date. */
export const isClock = (text: string): boolean => TIME_OF_DAY.test(text);

/** Seconds of a date and time, or of a time of day; null for another text. Times without a zone count as UTC. */
export function dateTime_s(text: string, monthFirst = true): number | null {
  const clock = TIME_OF_DAY.exec(text);
  if (clock) return clock_s(clock.slice(1));
  const found = datedParts(text, monthFirst);
  if (!found) return null;
  const [year, month, day] = found.date.map(Number);
  if (month < 1 || month > 12 || day < 1 || day > 31) return null;
  return days(year, month, day) * DAY_S + clock_s(found.rest.slice(0, 5)) - zone_s(found.rest[5]);
}

function datedParts(text: string, monthFirst: boolean): { date: string[]; rest: Parts } | null {
  const split = (
    [, a, b, c, ...rest]: RegExpExecArray,
    order: (a: string, b: string, c: string) => string[],
  ) => ({
    date: order(a, b, c),
    rest,
  });
  const yearFirst = YEAR_FIRST.exec(text);
  if (yearFirst) return split(yearFirst, (year, month, day) => [year, month, day]);
  const dayFirst = DAY_FIRST.exec(text);
  if (dayFirst) return split(dayFirst, (day, month, year) => [year, month, day]);
  const slashes = SLASHES.exec(text);
  if (slashes) return split(slashes, (a, b, year) => (monthFirst ? [year, a, b] : [year, b, a]));
  return null;
}

/** Whether dates with slashes have the month first: unless one of them has a first number above 12. */
export const isMonthFirst = (texts: readonly string[]): boolean =>
  texts.every((text) => Number(SLASHES.exec(text)?.[1] ?? 0) <= 12);

function clock_s([hours, minutes, seconds, decimals, half]: Parts): number {
  if (hours === undefined) return 0;
  const hour = half ? (Number(hours) % 12) + (half.toUpperCase() === "P" ? 12 : 0) : Number(hours);
  const whole = 3600 * hour + 60 * Number(minutes ?? 0) + Number(seconds ?? 0);
  return whole + (decimals ? Number(`0.${decimals}`) : 0);
}

function zone_s(zone: string | undefined): number {
  if (!zone || !/^[+-]/.test(zone)) return 0;
  const digits = zone.slice(1).replace(":", "");
  const seconds = 3600 * Number(digits.slice(0, 2)) + 60 * Number(digits.slice(2) || 0);
  return zone[0] === "-" ? -seconds : seconds;
}

/** Days since 1970-01-01 in the Gregorian calendar (Howard Hinnant, "days_from_civil"). */
function days(year: number, month: number, day: number): number {
  const y = month <= 2 ? year - 1 : year;
  const era = Math.floor(y / 400);
  const yearOfEra = y - era * 400;
  const dayOfYear = Math.floor((153 * (month + (month > 2 ? -3 : 9)) + 2) / 5) + day - 1;
  const dayOfEra = yearOfEra * 365 + Math.floor(yearOfEra / 4) - Math.floor(yearOfEra / 100) + dayOfYear;
  return era * 146_097 + dayOfEra - 719_468;
}
