import { describe, expect, test } from "vitest";
import { plainWind, withPlain } from "../../../../web/player/src/core/wind/edit";
import { DEFAULTS, defaultsFor, queryFromSettings, settingsFromQuery, treesBeyond } from "../../../../web/src/page/settings/settings";

describe("settings in the URL", () => {
  test("given values are used, missing ones keep their default", () => {
    const settings = settingsFromQuery("?trees=60&speed=12.5&lookup=server&panel=0&quality=low");
    expect(settings).toMatchObject({ trees: 60, lookup: "server", panel: false, quality: "low" });
    expect(settings.wind).toEqual(plainWind({ ...DEFAULTS.wind, mean_speed_m_s: 12.5 }));
    expect(settings.forestSeed).toBe(DEFAULTS.forestSeed);
  });

  test("numbers are clamped and invalid values ignored", () => {
    const settings = settingsFromQuery("?trees=1e9&speed=-3&gust=NaN&seed=&direction=abc&lookup=moon&form=bonsai&forest=3.7&fps=0");
    expect(settings).toEqual({ ...DEFAULTS, trees: 100_000, wind: withPlain(DEFAULTS.wind, { mean_speed_m_s: 0 }), forestSeed: 4, frameRateLimit_hz: 5 });
  });

  test("a link with too many trees is recognised", () => {
    expect(treesBeyond("?trees=300000")).toBe(300_000);
    for (const query of ["", "?trees=100000", "?trees=many", "?speed=3"]) expect(treesBeyond(query)).toBeNull();
  });

  test("a query restores its settings and is empty for the defaults", () => {
    expect(queryFromSettings(DEFAULTS)).toBe("");
    const changed = { ...DEFAULTS, trees: 3, form: "forest" as const, poseEasing: 0.25, flutter: false, wind: withPlain(DEFAULTS.wind, { direction_deg: 271, seed: 9 }) };
    expect(settingsFromQuery(`?${queryFromSettings(changed)}`)).toEqual(changed);
  });

  test("the number of own trees is within what a server holds, and is part of the link", () => {
    const own = (query: string) => settingsFromQuery(query).ownTrees;
    expect([own(""), own("own=24"), own("own=99"), own("own=-1"), own("own=all")]).toEqual([0, 24, 40, 0, 0]);
    expect(queryFromSettings({ ...DEFAULTS, ownTrees: 24 })).toBe("own=24");
  });

  test("the method is one of the two known ones", () => {
    const paper = { ...DEFAULTS, method: "paper" as const };
    expect(settingsFromQuery("?method=modal", paper).method).toBe("modal");
    expect(settingsFromQuery("?method=drift", paper).method).toBe("paper");
    expect(queryFromSettings(DEFAULTS, paper)).toBe("method=modal");
  });

  test("small screens and software rendering start with lower settings", () => {
    const desktop = defaultsFor({ width_px: 1280, touch: false, software: false });
    expect(desktop.trees).toBe(400);
    expect(defaultsFor({ width_px: 390, touch: true, software: false }).trees).toBeLessThan(desktop.trees);
    expect(defaultsFor({ width_px: 1280, touch: false, software: true }).quality).toBe("low");
  });
});
