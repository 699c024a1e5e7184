import { expect, test } from "vitest";
import { DEFAULTS, queryFromSettings, settingsFromQuery } from "../../../../web/src/page/settings/settings";
import { windFromQuery } from "../../../../web/src/page/settings/windQuery";
import { parseWind, type WindDocument } from "../../../../web/player/src/core/wind/document";
import { WindError } from "../../../../web/player/src/core/wind/fields";
import { CALM_BREEZE, PRESETS, paperWind } from "../../../../web/player/src/core/wind/presets";
import { changeWind, parseState, steady } from "../../../../web/player/src/core/wind/transition";
import { random } from "../../golden";
import { gustSpeed_m_s, plainWind, withMean, withPlain } from "../../../../web/player/src/core/wind/edit";

const WINDS: readonly WindDocument[] = [CALM_BREEZE, ...Object.values(PRESETS), paperWind(2, 11, 200)];

test("every wind is restored from the link", () => {
  for (const wind of WINDS) {
    const query = `?${queryFromSettings({ ...DEFAULTS, trees: 9, wind })}`;
    expect(settingsFromQuery(query)).toEqual({ ...DEFAULTS, trees: 9, wind });
  }
  expect(windFromQuery("?trees=9")).toBeNull();
});

test("a recording is too long for a link: its mean, direction and gustiness stand for it", () => {
  const recording = { interval_s: 0.5, unit: 0.01, pairs: "AAAAAAAAAAA=" };
  const recorded: WindDocument = {
    ...plainWind({ mean_speed_m_s: 9.234, direction_deg: -33.4, gustiness: 0.617, seed: 1 }),
    model: "recorded",
    recording,
  };
  const query = new URLSearchParams(queryFromSettings({ ...DEFAULTS, wind: recorded }));
  expect(Object.fromEntries(query)).toEqual({ speed: "9.2", direction: "327", gust: "0.62" });
});

test("an invalid wind in a link is rejected with its path", () => {
  expect(() => windFromQuery("?wind=gale")).toThrow(WindError);
  const bad = encodeURIComponent(JSON.stringify({ ...PRESETS.breeze, length_scale_m: 500 }));
  expect(() => windFromQuery(`?wind=${bad}`)).toThrow(/wind\.length_scale_m: expected a number in 5\.\.200, not 500/);
});

test("a link holds a plain wind as four numbers and any other wind as a document", () => {
  const queryOf = (wind: WindDocument) => queryFromSettings({ ...DEFAULTS, wind });
  expect(queryOf(withPlain(DEFAULTS.wind, { mean_speed_m_s: 12, direction_deg: 271 }))).toBe("speed=12&direction=271");
  expect(windFromQuery(queryOf({ ...DEFAULTS.wind, direction_deg: 30.5 }))).toMatchObject({ direction_deg: 30.5 });
  // The whole range of the wind document, not only what the page used to offer.
  for (const mean_speed_m_s of [40, 60]) {
    const wind = withPlain(DEFAULTS.wind, { mean_speed_m_s });
    expect(queryOf(wind)).toBe(`speed=${mean_speed_m_s}`);
    expect(settingsFromQuery(queryOf(wind)).wind).toEqual(wind);
  }
  expect(settingsFromQuery("?speed=61").wind.mean_speed_m_s).toBe(60);
  expect(settingsFromQuery(queryOf({ ...DEFAULTS.wind, direction_deg: -30 })).wind).toMatchObject({ direction_deg: 330 });
});

test("plain numbers in a link change only these fields of the stored wind", () => {
  const before = { ...DEFAULTS, wind: PRESETS["storm-front"] };
  const { wind } = settingsFromQuery("?gust=0.1", before);
  expect(wind).toEqual({ ...PRESETS["storm-front"], gustiness: 0.1 });
  expect(settingsFromQuery("?wind=gale&gust=0.1", before).wind).toEqual(wind);
  expect(plainWind(DEFAULTS.wind)).toEqual(DEFAULTS.wind);
});

test("the sliders of the panel change only their fields of the wind", () => {
  const wind = withPlain(PRESETS["storm-front"], { gustiness: 0.1, direction_deg: 300 });
  expect(parseWind(wind)).toEqual({ ...PRESETS["storm-front"], gustiness: 0.1, direction_deg: 300 });
});

test.each(["opening", ...Object.keys(PRESETS)])("the arrow keeps the gust model and the gusts within the crowns: %s", (name) => {
  const wind = name === "opening" ? DEFAULTS.wind : PRESETS[name as keyof typeof PRESETS];
  expect(wind.model).not.toBe("cosine"); // which has no gusts within crowns
  for (const mean_speed_m_s of [0, 0.3, 7, 20, 60]) {
    const dragged = parseWind(withMean(wind, mean_speed_m_s, 200));
    const { model, length_scale_m, gustiness, seed } = wind;
    expect(dragged).toMatchObject({ model, length_scale_m, gustiness, seed, mean_speed_m_s });
  }
});

test("gusts that travel with the mean wind follow its changes, others keep their speed", () => {
  const together = { ...CALM_BREEZE, convection_speed_m_s: gustSpeed_m_s(CALM_BREEZE.mean_speed_m_s) };
  expect(withMean(together, 13, 5)).toMatchObject({ convection_speed_m_s: 13, direction_deg: 5 });
  expect(withMean(together, 0, 5).convection_speed_m_s).toBeGreaterThan(0.5);
  expect(withMean(PRESETS["autumn-gusts"], 3, 5).convection_speed_m_s).toBe(10);
});

test("a wind in transition is always a valid document (seed 8)", () => {
  const next = random(8);
  let state = steady(PRESETS["autumn-gusts"]);
  for (let k = 0; k < 300; k++) {
    const corner = (low: number, high: number) => [low, high, low + next() * (high - low)][Math.floor(3 * next())];
    const wild = {
      mean_speed_m_s: corner(0, 60),
      direction_deg: corner(-360, 360),
      gustiness: corner(0, 1),
      length_scale_m: corner(5, 200),
    };
    state = changeWind(state, { ...PRESETS["autumn-gusts"], ...wild, seed: Math.floor(3 * next()) }, 0.17 * k);
    expect(parseState(structuredClone(state))).toEqual(state);
  }
});
