/** The npm package as strangers get it: the built files, in Node. */
import { execFileSync } from "node:child_process";
import { existsSync, readdirSync, readFileSync, statSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { Matrix4, Quaternion, Vector3 } from "three";
import { beforeAll, describe, expect, test } from "vitest";
import { INSTANCE_FLOATS } from "../../web/player/src/trees/instanceData";
import type * as Core from "../../web/player/src/core";
import { instancesOf, placementOf } from "../../web/player/src/three/standing";
import { Stepper } from "../../web/player/src/worker/simple/stepper";
import { golden, goldenJson, random } from "./golden";

const PLAYER = fileURLToPath(new URL("../../web/player/", import.meta.url));
const DIST = `${PLAYER}dist/`;
/** Bytes, gzip: everything that plays a forest; the custom element; what streams need besides. */
const MOST_BYTES = 40 * 1024;
const MOST_ELEMENT_BYTES = 2_000;
const MOST_STREAM_BYTES = 40_000;
const STREAM = ["stream.js", "galewood.stream.worker.js"];

/** Newest change of the sources that the package is built from. */
function newest(folder: string): number {
  const entries = readdirSync(folder, { recursive: true, withFileTypes: true });
  const files = entries.filter((one) => one.isFile());
  return files.reduce((most, one) => Math.max(most, statSync(`${one.parentPath}/${one.name}`).mtimeMs), 0);
}

let core: typeof Core;
beforeAll(async () => {
  const sources = [`${PLAYER}src`, ...["core", "worker", "scene/trees"].map((name) => `${PLAYER}../src/${name}`)];
  const built = existsSync(`${DIST}core.js`) ? statSync(`${DIST}core.js`).mtimeMs : 0;
  if (sources.some((folder) => newest(folder) > built))
    execFileSync(process.execPath, [`${PLAYER}build.mjs`], { stdio: "pipe" });
  core = await import(/* @vite-ignore */ `${DIST}core.js`);
}, 120_000);

const scripts = () => readdirSync(DIST).filter((name) => name.endsWith(".js"));

describe("the built package", () => {
  test("plays within 40 KiB, compressed, with worker and kernel", () => {
    const bytes = (names: readonly string[]) =>
      names.reduce((sum, name) => sum + gzipSync(readFileSync(DIST + name), { level: 9 }).length, 0);
    const playing = scripts().filter((name) => name !== "element.js" && !STREAM.includes(name));
    expect(bytes(playing)).toBeLessThanOrEqual(MOST_BYTES);
    expect(bytes(["element.js"])).toBeLessThanOrEqual(MOST_ELEMENT_BYTES);
    expect(bytes(STREAM)).toBeLessThanOrEqual(MOST_STREAM_BYTES);
  });

  test("core and worker need nothing but their own files; the rest only three.js in addition", () => {
    const imports = (name: string) =>
      Array.from(readFileSync(DIST + name, "utf8").matchAll(/\b(?:from|import)\s*[`"']([^`"']+)[`"']/g), ([, at]) => at);
    for (const name of scripts()) {
      for (const at of imports(name)) {
        if (/^three(\/|$)/.test(at)) expect(["three.js", "element.js", "served.chunk.js"]).toContain(name);
        else expect(existsSync(DIST + at), `${name} imports ${at}`).toBe(true);
      }
    }
  });

  test("every entry point of the manifest exists, with its types", () => {
    const { exports } = JSON.parse(readFileSync(`${PLAYER}package.json`, "utf8")) as {
      exports: Record<string, string | Record<string, string>>;
    };
    for (const entry of Object.values(exports)) {
      for (const file of typeof entry === "string" ? [entry] : Object.values(entry))
        expect(existsSync(PLAYER + file), file).toBe(true);
    }
  });

  test("workers are found by the expression that bundlers look for", () => {
    for (const file of ["galewood\\.worker", "galewood\\.stream\\.worker"]) {
      const quote = "[`\"']";
      const expression = new RegExp(
        `new Worker\\(new URL\\(${quote}\\./${file}\\.js${quote},\\s*import\\.meta\\.url\\),\\s*\\{\\s*type:\\s*${quote}module`,
      );
      expect(scripts().filter((name) => expression.test(readFileSync(DIST + name, "utf8")))).toHaveLength(1);
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
      "a table before version 7",
      () => core.readTable(golden("pole-v6.safetensors")),
      /version 6; this reader supports versions 7 to/,
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
});

describe("trees at matrices", () => {
  const seed = 5;
  const next = random(seed);
  const matrices = Array.from({ length: 20 }, () => {
    const turn = new Quaternion(next() - 0.5, next() - 0.5, next() - 0.5, next() - 0.5).normalize();
    const size = new Vector3(0.5 + next(), 0.5 + next(), 0.5 + next());
    return new Matrix4().compose(new Vector3(9 * next(), 3 * next(), 9 * next()), turn, size);
  });

  test(`the shader's arithmetic is that of the matrix (seed ${seed})`, () => {
    const { data } = instancesOf(matrices);
    for (const [k, matrix] of matrices.entries()) {
      const [x, y, z, , qx, qy, , , qz, qw, wide, deep] = data.subarray(k * INSTANCE_FLOATS);
      const v = new Vector3(0.3, 2.5, -0.7);
      const q = new Vector3(qx, qy, qz);
      const s = new Vector3(v.x * wide, v.y, v.z * deep);
      const spun = s
        .clone()
        .multiplyScalar(qw * qw - q.dot(q))
        .addScaledVector(q, 2 * q.dot(s))
        .addScaledVector(q.clone().cross(s), 2 * qw);
      expect(spun.add(new Vector3(x, y, z)).distanceTo(v.applyMatrix4(matrix))).toBeLessThan(1e-5);
    }
  });

  test("upright trees have yaw and scale; a mirrored one is refused", () => {
    const upright = new Matrix4().compose(
      new Vector3(1, 2, 3),
      new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), 0.7),
      new Vector3(2, 2, 2),
    );
    expect(instancesOf([upright]).anyhow?.upright).toBe(true);
    expect(instancesOf(matrices).anyhow?.upright).toBe(false);
    const [x, z, yaw, scale] = placementOf([upright], new Matrix4().makeTranslation(10, 0, 0));
    [x - 11, z - 3, yaw - 0.7, scale - 2].forEach((error) => expect(Math.abs(error)).toBeLessThan(1e-6));
    expect(() => instancesOf([new Matrix4().makeScale(-1, 1, 1)])).toThrow(/mirrors/);
  });
});

describe("the worker", () => {
  const table = () => golden("pole.safetensors").slice().buffer as ArrayBuffer;
  const frame = (stride: number) => ({ group: 0, poses: new Float32Array(stride), velocity: null });

  test("steps like the public forest; a group that moves keeps its pose", () => {
    const stepper = new Stepper();
    const motion = stepper.read(0, table());
    stepper.setWind(core.PRESETS["autumn-gusts"]);
    stepper.plant(0, 0, Float32Array.of(4, 5, 0.3, 1));
    const place = { x_m: 4, z_m: 5, yaw_rad: 0.3 };
    const read = core.readTable(table());
    const forest = core.createForest({ kinds: [{ table: read, places: [place] }], wind: core.PRESETS["autumn-gusts"] });
    const frames = [frame(motion.stride)];
    for (let k = 0; k < 90; k++) {
      stepper.advance(1 / 30, [4, 5], frames);
      forest.step(1 / 30);
    }
    const before = frames[0].poses.slice(0, motion.modes);
    expect(before).toEqual(forest.coordinates(0).slice());
    stepper.plant(0, 0, Float32Array.of(40, 5, 0.3, 1));
    stepper.advance(0, [4, 5], frames);
    const jump = before.reduce((most, value, k) => Math.max(most, Math.abs(value - frames[0].poses[k])), 0);
    expect(jump).toBeLessThan(1e-6);
  });
});

test("the peer dependency covers the tested releases of three.js and no later one", () => {
  const { peerDependencies, devDependencies } = JSON.parse(readFileSync(`${PLAYER}package.json`, "utf8"));
  const installed = JSON.parse(readFileSync(`${PLAYER}../node_modules/three/package.json`, "utf8")).version;
  const minor = Number(installed.split(".")[1]);
  expect(peerDependencies.three).toBe(`>=0.${minor - 3}.0 <0.${minor + 1}.0`);
  expect(Object.keys(devDependencies)).toEqual(
    expect.arrayContaining([1, 2, 3].map((back) => `three-${minor - back}`)),
  );
});
