/** The wind risk of stems: classes and their colours, words, and what is asked of the service. */
import { afterEach, describe, expect, test, vi } from "vitest";
import { type ColourClass, classWords, colouringOf, QUANTITIES } from "../../../web/src/page/risk/colourScale";
import { stemFigures, stemMarks, stemName } from "../../../web/src/page/risk/stemWords";
import { Problem } from "../../../web/src/page/server/api";
import { fetchRisk, type StemRisk } from "../../../web/src/page/server/conversion";
import { idOfStem, stemOf } from "../../../web/src/scene/stand";

const STEM: StemRisk = {
  rank: 3, index: 0, line: 12, species: "Rotbuche", tree: "maple-forest", wood: "default", east_m: 0, north_m: 0,
  lon_deg: null, lat_deg: null, height_m: 21.5, height_estimated: true, dbh_cm: 24, dbh_assumed: false, rough: false,
  frequency_hz: 0.418, edge_distance_m: 12.4, load_share: 0.776, direction_deg: 90, sway_m: 0.853, base_moment_knm: 12.345,
  strain: 0.00212, critical_m_s: 31.25, critical_low_m_s: 25, critical_high_m_s: null,
};
const stand = (values: readonly (number | null)[]) => ({
  stems: values.map((critical_m_s, index) => ({ ...STEM, index, critical_m_s })),
});

describe("classes", () => {
  test("hold equal numbers, the weakest first, and name their ranges", () => {
    const values = Array.from({ length: 70 }, (_, k) => 10 + ((k * 37) % 70));
    const { classes, colours } = colouringOf(stand(values), "critical");
    expect(classes.map(({ stems }) => stems)).toEqual([10, 10, 10, 10, 10, 10, 10]);
    expect(classes.map((one) => classWords("critical", one))).toEqual(
      [10, 20, 30, 40, 50, 60, 70].map((from) => `${from}.0 to ${from + 9}.0`),
    );
    values.forEach((value, k) => {
      const own = classes.findIndex(({ worst, best }) => value >= worst && value <= best);
      expect(colours[k]).toBe(classes[own].colour);
    });
  });

  test("a large strain is as bad as a small critical wind", () => {
    const stems = [0.001, 0.004, 0.002].map((strain) => ({ ...STEM, strain }));
    const { classes } = colouringOf({ stems }, "strain");
    expect(classes.map((one) => classWords("strain", one))).toEqual(["4.00", "2.00", "1.00"]);
    expect(classes[0].colour).toBe(colouringOf(stand([10, 20, 30]), "critical").classes[0].colour);
  });

  test("equal stems have one colour, and those that do not break come last", () => {
    const { classes, colours } = colouringOf(stand([null, 20, null, 20, 20, null]), "critical");
    expect(new Set([colours[1], colours[3], colours[4]]).size).toBe(1);
    expect(classes.map((one) => [classWords("critical", one), one.stems])).toEqual([["20.0", 3], ["over 100", 3]]);
    expect(colouringOf(stand([15]), "critical").classes).toHaveLength(1);
  });
});

/** Machado, Oliveira, Fernandes (IEEE TVCG 15, 2009), severity 1, on linear RGB. */
const VISION = {
  normal: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
} as const;

/** CIELAB of an sRGB colour as it is seen (D65). */
function seen(colour: string, matrix: readonly number[]): number[] {
  const linear = [1, 3, 5].map((at) => {
    const c = Number.parseInt(colour.slice(at, at + 2), 16) / 255;
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  });
  const times = (m: readonly number[], v: readonly number[]) =>
    [0, 3, 6].map((row) => m[row] * v[0] + m[row + 1] * v[1] + m[row + 2] * v[2]);
  const rgb = times(matrix, linear).map((c) => Math.min(1, Math.max(0, c)));
  const toXyz = [0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505];
  const [x, y, z] = times(toXyz, rgb).map((c, k) => {
    const t = c / [0.9505, 1, 1.089][k];
    return t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116;
  });
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

test.each(Object.entries(VISION))("the classes differ in %s vision", (_, matrix) => {
  const values = Array.from({ length: 70 }, (_, k) => k);
  const colours = colouringOf(stand(values), "critical").classes.map(({ colour }: ColourClass) => seen(colour, matrix));
  colours.forEach((a, k) => {
    for (const b of colours.slice(k + 1)) {
      expect(Math.hypot(...a.map((value, i) => value - b[i]))).toBeGreaterThan(10); // 2.3 are just noticeable
    }
  });
});

test("a stem is described with units, its uncertainty and what is not measured", () => {
  const figures = Object.fromEntries(stemFigures(STEM, 300, 25));
  expect(figures).toMatchObject({
    "Breaks at": "31.3 m/s",
    "10 to 90 %": "25.0 to over 100 m/s",
    Rank: "3 of 300",
    "Sway at 25 m/s": "0.85 m",
    "Largest strain": "2.12 mm/m",
    "Moment at the ground": "12.3 kN·m",
    "First frequency": "0.42 Hz",
    Height: "21.5 m *",
    "Diameter at 1.3 m": "24.0 cm",
    "Tree used": "Maple, forest-grown",
    Wood: "average",
  });
  expect(Object.fromEntries(stemFigures({ ...STEM, tree: "poplar", wood: "oak" }, 1, 20))).toMatchObject({
    "Tree used": "Poplar, open-grown",
    Wood: "oak",
  });
  expect(stemMarks({ ...STEM, height_estimated: false, wood: "oak" }, 40)).toEqual([expect.stringContaining("breaks below 40 m/s")]);
  expect(stemMarks(STEM, 25)).toEqual([expect.stringContaining("height is not measured"), expect.stringContaining("average wood")]);
  expect(stemMarks({ ...STEM, height_estimated: false, wood: "oak" }, 25)).toEqual([]);
  expect([stemName(STEM), stemName({ ...STEM, species: "" })]).toEqual(["Rotbuche, line 12", "Unknown species, line 12"]);
});

test("every quantity has a unit", () => {
  for (const { unit } of Object.values(QUANTITIES)) expect(unit).not.toBe("");
});

test("places of stems are told from those of other trees", () => {
  expect([stemOf(idOfStem(7)), stemOf(7), stemOf(2 ** 24)]).toEqual([7, null, null]);
});

describe("the request", () => {
  afterEach(() => void vi.unstubAllGlobals());
  const request = { foliage: "bare", speed_m_s: 25 } as const;

  test("sends the inventory as it is", async () => {
    const sent = vi.fn(async (_path: string, _init?: RequestInit) => new Response("{}"));
    vi.stubGlobal("fetch", sent);
    await fetchRisk(new Blob(["x,y"]), request, "csv");
    const [path, init] = sent.mock.calls[0];
    expect(path).toBe("api/stand-risk?foliage=bare&speed_m_s=25&format=csv");
    expect(new TextDecoder().decode(init?.body as ArrayBuffer)).toBe("x,y");
  });

  test("says what is wrong", async () => {
    vi.stubGlobal("fetch", async () => new Response("none", { status: 404 }));
    await expect(fetchRisk(new Blob(), request, "json")).rejects.toMatchObject({
      title: "Only a service can compute the wind risk.",
    });
    const gone = { arrayBuffer: () => Promise.reject(new DOMException("", "NotReadableError")) } as unknown as Blob;
    await expect(fetchRisk(gone, request, "json")).rejects.toBeInstanceOf(Problem);
    const aborted = new AbortController();
    aborted.abort();
    vi.stubGlobal("fetch", async () => {
      throw new DOMException("", "AbortError");
    });
    await expect(fetchRisk(new Blob(), request, "json", aborted.signal)).rejects.toThrow(DOMException);
  });
});
