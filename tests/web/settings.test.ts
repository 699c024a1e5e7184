import { describe, expect, test } from "vitest";
import { DEFAULTS, defaultsFor, queryFromSettings, settingsFromQuery } from "../../web/src/page/settings/settings";

describe("settings in the address", () => {
  test("what is given is taken, what is missing keeps its default", () => {
    const settings = settingsFromQuery("?trees=60&speed=12.5&lookup=server&panel=0&quality=low");
    expect(settings).toMatchObject({ trees: 60, meanSpeed_m_s: 12.5, lookup: "server", panel: false, quality: "low" });
    expect(settings.gustiness).toBe(DEFAULTS.gustiness);
  });

  test("numbers are brought into range and rubbish is passed over", () => {
    const settings = settingsFromQuery("?trees=1e9&speed=-3&gust=NaN&seed=&direction=abc&lookup=moon&forest=3.7");
    expect(settings).toEqual({ ...DEFAULTS, trees: 10_000, meanSpeed_m_s: 0, forestSeed: 4 });
  });

  test("a query gives its settings back, and is empty for the defaults", () => {
    expect(queryFromSettings(DEFAULTS)).toBe("");
    const changed = { ...DEFAULTS, trees: 3, poseEasing: 0.25, flutter: false, direction_deg: 271, windSeed: 9 };
    expect(settingsFromQuery(`?${queryFromSettings(changed)}`)).toEqual(changed);
  });

  test("a small or software-drawn screen starts with less", () => {
    const desktop = defaultsFor({ width_px: 1280, touch: false, software: false });
    expect(desktop.trees).toBe(400);
    expect(defaultsFor({ width_px: 390, touch: true, software: false }).trees).toBeLessThan(desktop.trees);
    expect(defaultsFor({ width_px: 1280, touch: false, software: true }).quality).toBe("low");
  });
});
