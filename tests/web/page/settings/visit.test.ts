import { describe, expect, it } from "vitest";
import { momentFrom, shareQuery } from "../../../../web/src/page/settings/link";
import { keep, keptOf, remembered } from "../../../../web/src/page/settings/storedSettings";
import { Store } from "../../../../web/src/page/store/store";
import { groundHeight_m } from "../../../../web/src/scene/ground/landscape";
import { leafTint } from "../../../../web/src/scene/season/palette";
import { chooseSpecies, placeTrees } from "../../../../web/src/scene/placement";
import { FLIGHT_S, flightAt, loneliest, VIEWS, type ViewName, viewpoint } from "../../../../web/src/scene/camera/viewpoints";
import { DEFAULTS, defaultsFor, type Settings, settingsFromQuery } from "../../../../web/src/page/settings/settings";
import { factsOf, sizeInWords, timeInWords } from "../../../../web/src/page/physics/physics";

const SETTINGS: Settings = {
  ...DEFAULTS,
  trees: 33,
  season: "winter",
  daytime: 0.9,
  density: 1.4,
  shares: { maple: 0.5, poplar: 0 },
  ownTrees: 24,
};
const MOMENT = {
  eye: [1.25, 9.5, -20.75],
  target: [-3, 4.5, 8],
  time_s: 123.45,
  clouds: [-0.1234, 2.5],
} as const;

describe("a shared link", () => {
  it("restores settings, camera and time, whatever the defaults of the receiver", () => {
    const query = shareQuery(SETTINGS, MOMENT);
    const phone = defaultsFor({ width_px: 390, touch: true, software: false });
    expect(settingsFromQuery(query, phone)).toEqual({ ...SETTINGS, quality: phone.quality });
    expect(momentFrom(query)).toEqual(MOMENT);
  });

  it("ignores invalid values", () => {
    const { ash: _, ...shares } = DEFAULTS.shares;
    const none = { eye: null, target: null, time_s: null, clouds: null };
    for (const query of ["", "view=1,2,3", "view=a,b,c,d,e,f&at=soon&clouds=1", "view=1,1,1,1,1,1e9&at=&clouds=,"]) {
      expect(momentFrom(query)).toEqual(none);
    }
    expect(settingsFromQuery("season=monsoon&time=x&mix=maple,::,poplar:-1,ash:9&density=99")).toEqual({
      ...DEFAULTS,
      density: 2,
      shares,
    });
  });
});

describe("settings from the last visit", () => {
  const shelfWith = (text: string | null) => () => ({ getItem: () => text, setItem: () => {} });

  it("are restored", () => {
    let text: string | null = null;
    const shelf = () => ({
      getItem: () => text,
      setItem: (_: string, value: string) => {
        text = value;
      },
    });
    keep(SETTINGS, DEFAULTS, shelf);
    expect(remembered(DEFAULTS, shelf)).toEqual(SETTINGS);
  });

  it("have neither an inventory nor the trees grown for its stems", () => {
    const store = new Store({ ...SETTINGS, inventory: "api/inventory" }, DEFAULTS, "");
    store.state.inventory = "loading";
    expect(keptOf(store)).toEqual({ ...SETTINGS, ownTrees: 0 });
    store.state.inventory = null;
    expect(keptOf(store)).toEqual(SETTINGS);
  });

  it("fall back to the defaults for invalid, missing or other-version data, or blocked storage", () => {
    const refuse = () => {
      throw new DOMException("forbidden", "SecurityError");
    };
    for (const text of [null, "", "{", "7", '{"version":2,"query":"trees=9"}', '{"version":1,"query":5}']) {
      expect(remembered(DEFAULTS, shelfWith(text))).toEqual(DEFAULTS);
    }
    expect(remembered(DEFAULTS, refuse)).toEqual(DEFAULTS);
    keep(SETTINGS, DEFAULTS, refuse);
  });
});

describe("views", () => {
  const trees = [
    { x: 0, z: 0, height_m: 10 },
    { x: 3, z: 0, height_m: 12 },
    { x: 30, z: -10, height_m: 9 },
  ];

  it("look at something from above the ground", () => {
    for (const name of Object.keys(VIEWS) as ViewName[]) {
      for (const subjects of [trees, []]) {
        const { eye, target } = viewpoint(name, subjects, { x: 0.5, z: 0.5 });
        expect(eye.y - groundHeight_m(eye.x, eye.z)).toBeGreaterThan(1.4);
        expect(Math.hypot(eye.x - target.x, eye.y - target.y, eye.z - target.z)).toBeGreaterThan(4);
      }
    }
    expect(loneliest(trees)).toBe(trees[2]);
  });

  it("the flight is one smooth loop above the ground", () => {
    let before = flightAt(-0.1).eye;
    for (let t = 0; t <= FLIGHT_S; t += 0.1) {
      const { eye } = flightAt(t);
      expect(eye.y - groundHeight_m(eye.x, eye.z)).toBeGreaterThan(1.9);
      const speed_m_s = Math.hypot(eye.x - before.x, eye.y - before.y, eye.z - before.z) / 0.1;
      expect(speed_m_s).toBeLessThan(9);
      before = eye;
    }
    for (const axis of ["x", "y", "z"] as const) {
      expect(flightAt(FLIGHT_S + 3).eye[axis]).toBeCloseTo(flightAt(3).eye[axis], 9);
    }
  });
});

describe("the mix of species", () => {
  const count = (shares: Record<string, number>) => {
    const choice = chooseSpecies(placeTrees(4000, 7), ["poplar", "maple", "apricot"], shares);
    return [0, 1, 2].map((k) => choice.filter((pick) => pick === k).length);
  };

  it("excludes a share of 0, and reduces a small one", () => {
    const even = count({});
    for (const trees of even) expect(trees).toBeGreaterThan(900);
    const [poplar, maple, apricot] = count({ poplar: 0, maple: 0.25 });
    expect(poplar).toBe(0);
    expect(maple).toBeLessThan(0.45 * apricot);
    expect(count({ poplar: 0, maple: 0, apricot: 0 })).toEqual([0, 0, 0]);
  });

  it("a higher density moves trees closer and keeps their number", () => {
    const reach = (density: number) =>
      Math.max(...placeTrees(500, 7, density).map(({ x_m, z_m }) => Math.hypot(x_m, z_m + 26)));
    expect(placeTrees(500, 7, 2)).toHaveLength(500);
    expect(reach(2)).toBeLessThan(0.85 * reach(1));
    expect(reach(0.5)).toBeGreaterThan(1.2 * reach(1));
  });

  it("leaves are green in summer and red on maples in autumn", () => {
    for (let tree = 0; tree < 50; tree++) {
      const [r, g] = leafTint("maple", tree, "summer");
      expect(g).toBeGreaterThan(1.5 * r);
    }
    const red = Array.from({ length: 50 }, (_, tree) => leafTint("maple", tree, "autumn"));
    expect(red.filter(([r, g]) => r > 2 * g).length).toBeGreaterThan(25);
  });
});

describe("the physics card", () => {
  it("shows the values of the report and omits missing ones", () => {
    expect(factsOf({ height_m: null, report: null }, null)).toEqual([]);
    const report = {
      model: { frequencies_hz: [0.7129, 0.728, 0.8], damping: { shown: 0.0299 } },
      meshing: { tets: 4150 },
      seconds: { import: 1.1, sampling: 60 },
      table: { records: 7568, errors: { truncation_max_m: 0.0075 } },
      bare_table: { model: { frequencies_hz: [0.9051] } },
    };
    const said = Object.fromEntries(factsOf({ height_m: 13.16, report }, 7_813_436).map((f) => [f.name, f.value]));
    expect(said).toMatchObject({
      Height: "13.2 m",
      "First natural frequency": "0.71 Hz",
      "First frequency without leaves": "0.91 Hz",
      "Damping ratio": "3.0 %",
      "Finite elements": "4,150",
      Records: "7,568",
      "Table size": "7.8 MB",
      "Computation time": "61 s",
      "Truncation error": "0.06 % of height",
    });
    expect(said.Modes).toBeUndefined();
    expect([sizeInWords(1234), timeInWords(3.21), timeInWords(200)]).toEqual(["1 kB", "3.2 s", "3.3 min"]);
  });
});
