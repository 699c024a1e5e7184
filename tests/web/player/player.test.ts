/** The npm package as strangers get it: the built files, in Node. */
import { execFileSync } from "node:child_process";
import { existsSync, readdirSync, readFileSync, statSync } from "node:fs";
import { SourceMap } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { beforeAll, describe, expect, test } from "vitest";
import type * as Core from "../../../web/player/src/core";
import { PRESETS } from "../../../web/player/src/core/wind/presets";
import { golden, goldenJson } from "../golden";
import { tampered } from "../tableFile";

const PLAYER = fileURLToPath(new URL("../../../web/player/", import.meta.url));
const DIST = `${PLAYER}dist/`;
const PAGE = `${PLAYER}../src/`;
/** Bytes, gzip: everything that plays a forest; the custom element; what streams need besides; the forest for WebGPURenderer; compute shaders. */
const MOST_BYTES = 43_500;
const MOST_ELEMENT_BYTES = 2_400;
const MOST_STREAM_BYTES = 40_000;
const MOST_WEBGPU_BYTES = 20_300;
const MOST_COMPUTE_BYTES = 26_000;
const STREAM = ["stream.js", "galewood.stream.worker.js"];

/** Newest change of the sources that the package is built from. */
function newest(folder: string): number {
  const entries = readdirSync(folder, { recursive: true, withFileTypes: true });
  const files = entries.filter((one) => one.isFile());
  return files.reduce((most, one) => Math.max(most, statSync(`${one.parentPath}/${one.name}`).mtimeMs), 0);
}

interface Manifest {
  readonly exports: Readonly<Record<string, string | Readonly<Record<string, string>>>>;
}

const manifest = () => JSON.parse(readFileSync(`${PLAYER}package.json`, "utf8")) as Manifest;

/** Subpaths of the package that the page imports, with the names of the values it takes. */
function importsOfPage(): Map<string, Set<string>> {
  const used = new Map<string, Set<string>>();
  for (const file of readdirSync(PAGE, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".ts"))) {
    const text = readFileSync(PAGE + file, "utf8");
    for (const [, what = "", from] of text.matchAll(/\b(?:import|export)\s+([^;"']*?from\s+)?"(galewood[^"]*)"/g)) {
      const names = used.get(from) ?? new Set();
      const values = what.startsWith("type ") ? "" : (/\{([^}]*)\}/.exec(what)?.[1] ?? "");
      for (const name of values.split(",").map((one) => one.trim()))
        if (name !== "" && !name.startsWith("type ")) names.add(name.split(" ")[0]);
      used.set(from, names);
    }
  }
  return used;
}

let core: typeof Core;
beforeAll(async () => {
  const built = existsSync(`${DIST}core.js`) ? statSync(`${DIST}core.js`).mtimeMs : 0;
  if (newest(`${PLAYER}src`) > built)
    execFileSync(process.execPath, [`${PLAYER}build.mjs`], { stdio: "pipe" });
  core = await import(/* @vite-ignore */ `${DIST}core.js`);
});

test("every entry point but the workers can be imported where there is no DOM, as on a server", async () => {
  for (const [name, entry] of Object.entries(manifest().exports)) {
    if (typeof entry === "string" || name.endsWith("worker")) continue;
    await import(/* @vite-ignore */ `${PLAYER}${entry.default}`);
  }
});

const scripts = () => readdirSync(DIST).filter((name) => name.endsWith(".js"));
const AT_ONCE = /\b(?:from|import)\s*[`"']([\w@./-]+)[`"']/g;
const AT_ONCE_OR_LATER = /\b(?:from|import\s*\(?)\s*[`"']([\w@./-]+)[`"']/g;
const importsOf = (name: string, when = AT_ONCE_OR_LATER) =>
  Array.from(readFileSync(DIST + name, "utf8").matchAll(when), ([, at]) => at);

/** Built files, and all that they import. */
function closureOf(names: readonly string[], when = AT_ONCE_OR_LATER): string[] {
  const found = new Set<string>();
  const add = (name: string) => {
    if (found.has(name)) return;
    found.add(name);
    for (const at of importsOf(name, when)) if (at.startsWith("./")) add(at.slice(2));
  };
  names.forEach(add);
  return [...found];
}

describe("the built package", () => {
  test(`plays within ${MOST_BYTES} bytes, compressed, with worker and kernel`, () => {
    const bytes = (names: readonly string[]) =>
      names.reduce((sum, name) => sum + gzipSync(readFileSync(DIST + name), { level: 9 }).length, 0);
    const playing = closureOf(["core.js", "three.js", "galewood.worker.js"]);
    expect(bytes(playing)).toBeLessThanOrEqual(MOST_BYTES);
    expect(closureOf(["element.js"], AT_ONCE).filter((name) => !playing.includes(name))).toEqual(["element.js"]);
    expect(bytes(["element.js"])).toBeLessThanOrEqual(MOST_ELEMENT_BYTES);
    expect(bytes(STREAM)).toBeLessThanOrEqual(MOST_STREAM_BYTES);
    expect(bytes(["webgpu.js"])).toBeLessThanOrEqual(MOST_WEBGPU_BYTES);
    expect(bytes(["compute.js"])).toBeLessThanOrEqual(MOST_COMPUTE_BYTES);
    for (const page of ["../../README.md", "README.md"]) {
      const stated = /([\d.]+) kB with worker and kernel|with worker and kernel, ([\d.]+) kB/.exec(
        readFileSync(PLAYER + page, "utf8"),
      );
      expect(Number(stated?.[1] ?? stated?.[2]), page).toBeCloseTo(bytes(playing) / 1000, 0);
    }
  });

  test("needs nothing but its own files, and three.js only to draw", () => {
    const drawing = ["three.js", "webgpu.js", "compute.js", "element.js", "trees.js", "inventory.js"];
    for (const name of scripts()) {
      for (const at of importsOf(name)) {
        if (/^three(\/|$)/.test(at)) expect(drawing, `${name} imports ${at}`).toContain(name);
        else expect(existsSync(DIST + at), `${name} imports ${at}`).toBe(true);
      }
    }
    expect(closureOf(["inventory.js", "wind.js", "client.js"])).not.toContain("trees.js");
    // Who has one renderer loads no other one's code.
    for (const name of scripts()) {
      const needs = (when: RegExp) => importsOf(name, when).some((at) => /^three\/(webgpu|tsl)$/.test(at));
      expect(needs(AT_ONCE), name).toBe(["webgpu.js", "compute.js"].includes(name));
      // The custom element loads it when it is asked to.
      expect(needs(AT_ONCE_OR_LATER), name).toBe(["webgpu.js", "compute.js", "element.js"].includes(name));
    }
    expect(readFileSync(`${DIST}webgpu.js`, "utf8")).not.toContain("texelFetch");
  });

  test("holds every entry point of the manifest, with its types, and no sources", () => {
    const pack = ["pack", "--dry-run", "--json", "--ignore-scripts", "--offline"];
    const listed = execFileSync("npm", pack, { cwd: PLAYER, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
    const [{ files }] = JSON.parse(listed) as { files: { path: string }[] }[];
    const packed = new Set(files.map(({ path }) => `./${path}`));
    for (const [entry, targets] of Object.entries(manifest().exports)) {
      if (typeof targets === "string") continue; // package.json itself
      const { "galewood-source": from, ...given } = targets;
      expect(existsSync(PLAYER + from), entry).toBe(true);
      for (const file of Object.values(given)) expect(packed, entry).toContain(file);
    }
    expect([...packed].filter((path) => path.startsWith("./src/"))).toEqual([]);
  });

  test("exports all that the page imports, which imports nothing else of it", async () => {
    const used = importsOfPage();
    expect(used.size).toBeGreaterThan(5);
    for (const [entry, names] of used) {
      const targets = manifest().exports[entry.replace("galewood", ".")];
      if (!targets || typeof targets === "string") throw new Error(`${entry} is not exported`);
      if (entry.endsWith("-worker")) continue; // starts as soon as it is imported
      const module = await import(/* @vite-ignore */ PLAYER + targets.default);
      expect(Object.keys(module), entry).toEqual(expect.arrayContaining([...names]));
    }
  });

  test("has source maps, which lead from what is said in a browser to the line of the source", () => {
    const said = { "core/motion/steppedTrees.ts": "seconds from 0 on", "three/baseForest.ts": "use the GLB that belongs" };
    for (const [source, words] of Object.entries(said)) {
      const name = scripts().find((one) => readFileSync(DIST + one, "utf8").includes(words)) ?? "";
      const before = readFileSync(DIST + name, "utf8").split(words)[0].split("\n");
      const map = new SourceMap(JSON.parse(readFileSync(`${DIST}${name}.map`, "utf8")));
      const found = map.findEntry(before.length - 1, before[before.length - 1].length);
      if (!("originalSource" in found)) throw new Error(`${name} is not mapped`);
      expect(found.originalSource).toBe(`../src/${source}`);
      const lines = readFileSync(`${PLAYER}src/${source}`, "utf8").split("\n");
      // template literals are mapped as a whole, beginning with their first line
      expect(lines.slice(found.originalLine, found.originalLine + 3).join("\n")).toContain(words);
    }
  });

  test("has types by which the page compiles", () => {
    const configuration = `${PLAYER}tsconfig.page.json`;
    const tsc = `${PLAYER}../../node_modules/typescript/bin/tsc`;
    execFileSync(process.execPath, [tsc, "-p", configuration], { stdio: "pipe" });
  });

  test("has types whose imports Node resolves, too", () => {
    const types = `${DIST}types/`;
    for (const name of readdirSync(types, { recursive: true, encoding: "utf8" }).filter((one) => one.endsWith(".d.ts"))) {
      const relative = readFileSync(types + name, "utf8").matchAll(/\b(?:from|import\(|import) *"(\.[^"]+)"/g);
      for (const [, at] of relative) {
        expect(at, name).toMatch(/\.js$/);
        expect(existsSync(join(types, dirname(name), at.replace(/js$/, "d.ts"))), `${name} imports ${at}`).toBe(true);
      }
    }
  });

  test("workers are found by the expression that bundlers look for", () => {
    for (const [file, starters] of [
      ["galewood\\.worker", ["three.js", "webgpu.js"]],
      ["galewood\\.stream\\.worker", ["stream.js"]],
    ] as const) {
      const quote = "[`\"']";
      const expression = new RegExp(
        `new Worker\\(new URL\\(${quote}\\./${file}\\.js${quote},\\s*import\\.meta\\.url\\),\\s*\\{\\s*type:\\s*${quote}module`,
      );
      expect(scripts().filter((name) => expression.test(readFileSync(DIST + name, "utf8")))).toEqual(starters);
    }
  });
});

interface Drawn {
  q: number[];
  factor: number;
  rest_m: number[][];
  drawn_m: number[][];
}

interface Driven {
  frame_s: number;
  frames: number;
  every: number;
  trees: { x_m: number[]; z_m: number[]; yaw_rad: number[]; scale: number[] };
  winds: Core.WindDocument[];
  poses: number[][];
}

describe("galewood/core in Node", () => {
  const bytes = golden("pole.safetensors");

  test("moves vertices as Python does", () => {
    const table = core.readTable(bytes);
    const pose = new core.NodePose(core.jointsOf(table));
    const out = new Float64Array(3);
    for (const { q, factor, rest_m, drawn_m } of goldenJson<Drawn[]>("drawn.json")) {
      pose.take(q, 0, factor);
      for (const [vertex, [x, y, z]] of rest_m.entries()) {
        pose.place(vertex, x, y, z, out);
        for (const axis of [0, 1, 2]) expect(out[axis]).toBeCloseTo(drawn_m[vertex][axis], 5);
      }
    }
  });

  test("sways as in Python, in winds that change: to 1e-5 of the height", () => {
    const { frame_s, frames, every, trees, winds, poses } = goldenJson<Driven>("gusts.json");
    const places = trees.x_m.map((x_m, i) => ({
      x_m,
      z_m: trees.z_m[i],
      yaw_rad: trees.yaw_rad[i],
      scale: trees.scale[i],
    }));
    const table = core.readTable(bytes);
    const forest = core.createForest({ kinds: [{ table, places }], wind: winds[0] });
    const span = frames / winds.length;
    let worst = 0;
    for (let frame = 0; frame < frames; frame++) {
      if (frame > 0 && frame % span === 0) forest.setWind(winds[frame / span]);
      forest.step(frame_s);
      if (frame % every !== every - 1) continue;
      const expected = poses[(frame + 1) / every - 1];
      const found = places.flatMap((_, tree) => [...forest.coordinates(tree)]);
      worst = expected.reduce((most, value, k) => Math.max(most, Math.abs(value - found[k])), worst);
    }
    expect(worst / table.metadata.height_m).toBeLessThan(1e-5);
  });

  test("a wind as a function is the wind of a document with the same velocities", () => {
    const table = core.readTable(bytes);
    const wind: Core.WindDocument = { ...core.PRESETS.breeze, gustiness: 0, height_exponent: 0, mean_speed_m_s: 5 };
    const turn = (wind.direction_deg * Math.PI) / 180;
    const velocity = { x: 5 * Math.cos(turn), z: 5 * Math.sin(turn) };
    const kinds = [{ table, places: [{ x_m: 3, z_m: -2, yaw_rad: 0.4, scale: 1.2 }] }];
    const [a, b] = [wind, () => velocity].map((one) => core.createForest({ kinds, wind: one }));
    for (let frame = 0; frame < 200; frame++) {
      a.step(1 / 30);
      b.step(1 / 30);
    }
    a.coordinates(0).forEach((value, k) => expect(b.coordinates(0)[k]).toBeCloseTo(value, 6));
    expect(Math.hypot(...a.nodes(0).displacement_m)).toBeGreaterThan(1e-3);
  });

  test("the function is asked at the place of each tree; trees in still air do not move", () => {
    const table = core.readTable(bytes);
    const places = [
      { x_m: 10, y_m: 2, z_m: 1 },
      { x_m: -10, y_m: 3, z_m: 1 },
    ];
    const asked = new Set<string>();
    const forest = core.createForest({
      kinds: [{ table, places }],
      wind: ({ x, y, z }) => {
        asked.add(`${x} ${y} ${z}`);
        return { x: x > 0 ? 8 : 0, z: 0 };
      },
    });
    for (let frame = 0; frame < 60; frame++) forest.step(1 / 30);
    expect([...asked].sort()).toEqual(["-10 3 1", "10 2 1"]);
    expect(Math.hypot(...forest.nodes(0).displacement_m)).toBeGreaterThan(1e-3);
    expect(Math.hypot(...forest.nodes(1).displacement_m)).toBe(0);
    const rest_m = new Float32Array([0.1, 2, 0.2]);
    expect(forest.vertices(1, rest_m)).toEqual(rest_m);
  });

  test.each([
    ["a tree that does not exist", () => core.createForest({ kinds: [], wind: core.PRESETS.still }).nodes(0), /tree 0/],
    ["what is not a table", () => core.readTable(new Uint8Array(64)), "table"],
    [
      "a table of another version",
      () => core.readTable(tampered(bytes, (_, metadata) => Object.assign(metadata, { version: 10 }))),
      /version 10; this reader knows version 1/,
    ],
    [
      "a tree of no size",
      () =>
        core.createForest({
          kinds: [{ table: core.readTable(bytes), places: [{ x_m: 0, z_m: 0, scale: 0 }] }],
          wind: core.PRESETS.still,
        }),
      /scale in 0..100/,
    ],
  ])("refuses %s", (_, act, fault) => {
    expect(act).toThrow(fault);
  });

  test.each([
    ["NaN", Number.NaN, /wind: expected an object/],
    ["a speed below 0", { ...PRESETS.breeze, mean_speed_m_s: -3 }, /wind.mean_speed_m_s: expected a number in 0/],
    ["an unknown model", { ...PRESETS.breeze, model: "typo" }, /wind.model: expected one of/],
  ])("refuses %s as a wind, and keeps the wind before", (_, wind, fault) => {
    const table = core.readTable(bytes);
    const kinds = [{ table, places: [{ x_m: 0, z_m: 0 }] }];
    const given = wind as unknown as Core.WindDocument;
    expect(() => core.createForest({ kinds, wind: given })).toThrow(fault);
    const [tried, twin] = [0, 1].map(() => core.createForest({ kinds, wind: PRESETS.breeze }));
    expect(() => tried.setWind(given)).toThrow(fault);
    for (const forest of [tried, twin]) for (let frame = 0; frame < 60; frame++) forest.step(1 / 30);
    expect(tried.coordinates(0)).toEqual(twin.coordinates(0));
  });

  test("refuses steps that are no time, and velocities that are no numbers", () => {
    const table = core.readTable(bytes);
    const kinds = [{ table, places: [{ x_m: 0, z_m: 0 }] }];
    const forest = core.createForest({ kinds, wind: core.PRESETS.breeze });
    for (const dt_s of [Number.NaN, -1, Number.POSITIVE_INFINITY])
      expect(() => forest.step(dt_s)).toThrow(/dt_s: expected seconds from 0 on/);
    forest.step(1 / 30);
    expect(forest.time_s).toBeCloseTo(1 / 30, 12);
    forest.setWind(() => ({ x: Number.NaN, z: 0 }));
    expect(() => forest.step(1 / 30)).toThrow(/wind function: expected numbers x and z/);
  });
});

test("the peer dependency covers the tested releases of three.js and no later one", () => {
  const { peerDependencies, devDependencies } = JSON.parse(readFileSync(`${PLAYER}package.json`, "utf8"));
  const installed = JSON.parse(readFileSync(`${PLAYER}../../node_modules/three/package.json`, "utf8")).version;
  const minor = Number(installed.split(".")[1]);
  expect(peerDependencies.three).toBe(`>=0.${minor - 3}.0 <0.${minor + 1}.0`);
  expect(Object.keys(devDependencies)).toEqual(
    expect.arrayContaining([1, 2, 3].map((back) => `three-${minor - back}`)),
  );
});
