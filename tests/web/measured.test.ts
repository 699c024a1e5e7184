import { describe, expect, test } from "vitest";
import { bytesOfBase64 } from "../../web/player/src/core/files/base64";
import { type Measurement, MeasurementError, readMeasurement } from "../../web/player/src/core/wind/measured/reading";
import { parseWind, type WindDocument, WindField } from "../../web/player/src/core/wind/wind";
import { readRows, textOf } from "../../web/player/src/files/rows";
import { goldenJson } from "./golden";

interface Golden {
  files: { name: string; text: string; start_s: number; report: Measurement["report"]; wind: WindDocument }[];
  refused: { name: string; text: string; error: string }[];
}

const golden = goldenJson<Golden>("measured.json");

const countsOf = (wind: WindDocument) => new Int16Array(bytesOfBase64(wind.recording?.pairs ?? "").buffer);

describe("reads the same wind as Python", () => {
  test.each(golden.files)("$name", ({ text, start_s, report, wind }) => {
    const found = readMeasurement(readRows(text), start_s);
    parseWind(found.wind);
    const { recording, ...numbers } = found.wind;
    const { recording: expected, ...expectedNumbers } = wind;
    for (const [name, value] of Object.entries({ ...expectedNumbers, ...report })) {
      const own = ({ ...numbers, ...found.report } as Record<string, unknown>)[name];
      if (typeof value === "number") expect(own, name).toBeCloseTo(value, 8);
      else expect(own, name).toEqual(value);
    }
    expect(recording?.interval_s).toBeCloseTo(expected?.interval_s ?? 0, 10);
    expect(recording?.unit).toBeCloseTo(expected?.unit ?? 0, 12);
    const [own, counts] = [countsOf(found.wind), countsOf(wind)];
    expect(own.length).toBe(counts.length);
    // sines and cosines differ in their last bit between platforms
    expect(Math.max(...own.map((count, k) => Math.abs(count - counts[k])))).toBeLessThanOrEqual(1);
  });

  test.each(golden.refused)("refuses $name", ({ text, error }) => {
    expect(() => readMeasurement(readRows(text))).toThrow(new MeasurementError(error));
  });
});

test("the wind at the origin is the measured one, and blows downwind later", () => {
  const text = golden.files.find(({ name }) => name === "steady")?.text.replace("7,5,270", "7,9,250") ?? "";
  const { wind } = readMeasurement(readRows(text));
  const field = new WindField(wind);
  const [u, v] = [new Float64Array(1), new Float64Array(1)];
  const angle = (250 * Math.PI) / 180;
  field.velocity([0], [0], 7, u, v);
  expect(u[0]).toBeCloseTo(-9 * Math.sin(angle), 3);
  expect(v[0]).toBeCloseTo(9 * Math.cos(angle), 3);
  const heading = (wind.direction_deg * Math.PI) / 180;
  field.velocity([35 * Math.cos(heading)], [35 * Math.sin(heading)], 7 + 35 / wind.convection_speed_m_s, u, v);
  expect(u[0]).toBeCloseTo(-9 * Math.sin(angle), 3);
  expect(v[0]).toBeCloseTo(9 * Math.cos(angle), 3);
});

test("reads the usual encodings", () => {
  const text = "t;Richtung (°)\n";
  const latin = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  expect(textOf(latin)).toBe(text);
  expect(textOf(new TextEncoder().encode(`\ufeff${text.replace("\n", "\r\n")}`))).toBe(text);
  const wide = new Uint8Array(new Uint16Array([...`\ufeff${text}`].map((letter) => letter.charCodeAt(0))).buffer);
  expect(textOf(wide).replace("\ufeff", "")).toBe(text);
});
