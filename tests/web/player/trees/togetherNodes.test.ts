/** Pass 1 of all species with one call per step: whose texels, poses and rows are where. */
import type { DataTexture, InstancedBufferGeometry, Mesh, RawShaderMaterial } from "three";
import { expect, test } from "vitest";
import type { DrawnMotion } from "../../../../web/player/src/core/table/drawnTable";
import { NODE_LEVEL_COUNT } from "../../../../web/player/src/trees/detail";
import type { DrawList } from "../../../../web/player/src/trees/drawList";
import { PERIODS } from "../../../../web/player/src/trees/nodes/levelPass";
import type { NodeRenderer } from "../../../../web/player/src/trees/nodes/nodeGraphics";
import type { LevelTexels } from "../../../../web/player/src/trees/nodes/treeNodes";
import type { SpeciesNodes } from "../../../../web/player/src/trees/together/speciesNodes";
import { TogetherNodes } from "../../../../web/player/src/trees/together/togetherNodes";
import { random } from "../../golden";

const SEED = 5;
const MAX_SIDE = 4096;
const ROUNDS = 25;

type Drawn = Mesh<InstancedBufferGeometry, RawShaderMaterial>;

/** Keeps what is drawn. */
function recorder(): { renderer: NodeRenderer; drawn: Drawn[] } {
  const drawn: Drawn[] = [];
  const render = (mesh: Drawn) => drawn.push(mesh);
  const renderer = { autoClear: true, getRenderTarget: () => null, setRenderTarget() {}, render };
  return { renderer: renderer as unknown as NodeRenderer, drawn };
}

/** A motion of so many modes, whose rows have numbers of its own. */
function motionOf(next: () => number, modes: number): DrawnMotion {
  const levels = Array.from({ length: NODE_LEVEL_COUNT }, (_, k) => {
    const nodes = Math.max(2, Math.floor((30 * next()) / (k + 1)));
    const coordinates = Uint16Array.from({ length: Math.max(1, modes - 3 * k) }, (_, mode) => mode);
    const quads = Math.ceil((coordinates.length + 1) / 4);
    const rows = () => Float32Array.from({ length: nodes * 12 * quads }, next);
    const rest_m = Float32Array.from({ length: 3 * nodes }, next);
    const parent = Uint16Array.from({ length: nodes }, (_, node) => Math.max(0, node - 1));
    return { nodes, coordinates, quads, basis: rows(), turn: rows(), rest_m, parent };
  });
  return { levels, modes, stride: modes + 1 } as unknown as DrawnMotion;
}

/** Trees of a species by level, in any order. */
function listOf(next: () => number, most: number): DrawList {
  const visible = Uint32Array.from({ length: NODE_LEVEL_COUNT }, () => Math.floor(most * next()));
  const hidden = Uint32Array.from({ length: NODE_LEVEL_COUNT }, () => Math.floor(3 * next()));
  const start = new Uint32Array(NODE_LEVEL_COUNT);
  for (let k = 1; k < NODE_LEVEL_COUNT; k++) start[k] = start[k - 1] + visible[k - 1] + hidden[k - 1];
  const count = start[NODE_LEVEL_COUNT - 1] + visible[NODE_LEVEL_COUNT - 1] + hidden[NODE_LEVEL_COUNT - 1];
  const order = Uint32Array.from({ length: count }, (_, slot) => count - 1 - slot);
  return { visible, hidden, start, order, share: new Float32Array(count) } as unknown as DrawList;
}

interface Own {
  readonly nodes: SpeciesNodes;
  readonly motion: DrawnMotion;
  list: DrawList;
  poses: Float32Array;
  /** As told last. */
  told: readonly LevelTexels[];
}

const dataOf = (mesh: Drawn, name: string) => (mesh.material.uniforms[name].value as DataTexture).image.data as Float32Array;

/** Checks what is drawn of all species. */
function check(species: readonly Own[], mesh: Drawn, { width, height }: { width: number; height: number }): void {
  const { geometry, material } = mesh;
  const [places, sizes] = ["aPlace", "aSizes"].map((name) => geometry.getAttribute(name).array);
  const poses = dataOf(mesh, "uPoses");
  const rows = dataOf(mesh, "uRows");
  expect(material.uniforms.uHeight.value).toBe(height);
  let endRow = 0;
  const used: [number, number][] = [];
  species.forEach(({ motion, list, told, poses: own }, k) => {
    motion.levels.forEach(({ nodes, quads, coordinates, basis }, level) => {
      const at = 4 * (k * NODE_LEVEL_COUNT + level);
      const [row, trees] = places.subarray(at, at + 2);
      const [, , pose, firstRow] = sizes.subarray(at, at + 4);
      expect([trees, places[at + 2], sizes[at]]).toEqual([list.visible[level] + list.hidden[level], nodes, quads]);
      expect(told[level]).toEqual({ first: row * width, trees, nodes });
      used.push([row, row + Math.ceil((trees * nodes) / width)]);
      expect(rows[4 * firstRow + 1]).toBe(basis[1]);
      for (let slot = 0; slot < trees; slot++) {
        const tree = list.order[list.start[level] + slot];
        const from = 4 * (pose + slot * quads);
        expect(poses[from]).toBe(own[tree * motion.stride]);
        expect(poses[from + coordinates.length], "wind").toBe(own[tree * motion.stride + motion.modes]);
      }
    });
  });
  for (const [from, end] of used.sort(([a, b], [c, d]) => a - c || b - d)) {
    expect(from).toBeGreaterThanOrEqual(endRow);
    endRow = end;
  }
  expect(endRow).toBeLessThanOrEqual(height);
}

test(`species share target, poses and rows, whatever is drawn of each (seed ${SEED})`, () => {
  const next = random(SEED);
  const all = new TogetherNodes(MAX_SIDE, { value: 1 });
  const species: Own[] = [];
  let moves = 0;
  let largest = 0;
  const plant = (modes: number) => {
    const motion = motionOf(next, modes);
    const own: Own = {
      motion,
      nodes: all.add(motion),
      list: listOf(next, 1),
      poses: new Float32Array(0),
      told: [],
    };
    species.push(own);
  };
  for (const modes of [5, 12, 30]) plant(modes);
  for (let round = 0; round < ROUNDS; round++) {
    if (round === 8) plant(17);
    if (round === 16) species.splice(1, 1)[0].nodes.dispose();
    for (const own of species) {
      const ending = round >= ROUNDS - 2; // with many trees, then with few, whose room is given back
      if (own.told.length > 0 && next() < 0.4 && !ending) continue; // in another turn
      own.list = listOf(next, ending ? [1000, 1][round - ROUNDS + 2] : 4 * (round + 1));
      own.poses = Float32Array.from({ length: own.list.order.length * own.motion.stride }, next);
      own.nodes.setPoses(own.poses, null);
      let moving = -1; // it is told of its own place first
      own.nodes.place(own.list, (texels) => {
        own.told = texels;
        moving++;
        moves += Math.sign(moving);
      });
    }
    const { renderer, drawn } = recorder();
    for (const { nodes } of species) nodes.render(renderer);
    expect(drawn).toHaveLength(2);
    expect(drawn[0].geometry.instanceCount).toBe(species.length * NODE_LEVEL_COUNT);
    check(species, drawn[0], all.target);
    const { width, height } = all.target;
    if (round === ROUNDS - 2) largest = width * height;
    if (round === ROUNDS - 1) expect(width * height).toBeLessThan(0.2 * largest);
  }
  expect(moves).toBeGreaterThan(0);
});

/** A species whose trees are drawn, in rest. */
function drawnSpecies(all: TogetherNodes, next: () => number, modes: number) {
  const motion = motionOf(next, modes);
  const nodes = all.add(motion);
  const list = listOf(next, 9);
  const poses = new Float32Array(list.order.length * motion.stride);
  nodes.setPoses(poses, null);
  nodes.place(list, () => {});
  return { nodes, poses };
}

test("all species are drawn once a frame, and again if poses have changed since", () => {
  const next = random(SEED);
  const all = new TogetherNodes(MAX_SIDE, { value: 1 });
  const species = [4, 8].map((modes) => drawnSpecies(all, next, modes));
  const { renderer, drawn } = recorder();
  const frame = () => {
    for (const { nodes } of species) nodes.render(renderer);
    return drawn.splice(0).length;
  };
  expect([frame(), frame()]).toEqual([2, 2]);
  const [first, second] = species;
  first.nodes.render(renderer);
  second.nodes.setPoses(second.poses, null);
  second.nodes.render(renderer);
  expect(drawn).toHaveLength(4);
});

test(`levels far away take every second or fourth pose, and keep the one before (seed ${SEED})`, () => {
  const next = random(SEED);
  const all = new TogetherNodes(MAX_SIDE, { value: 1 });
  const motion = motionOf(next, 6);
  const nodes = all.add(motion);
  const visible = new Uint32Array(NODE_LEVEL_COUNT).fill(1);
  const one = Uint32Array.from(visible, (_, k) => k);
  const list = { visible, hidden: new Uint32Array(NODE_LEVEL_COUNT), start: one, order: one, share: new Float32Array(NODE_LEVEL_COUNT) };
  const posesOf = (frame: number) => new Float32Array(NODE_LEVEL_COUNT * motion.stride).fill(frame);
  nodes.setPoses(posesOf(0), null);
  nodes.place(list as unknown as DrawList, () => {});
  const shown = (mesh: Drawn, level: number) => {
    const texel = 4 * mesh.geometry.getAttribute("aSizes").array[4 * level + 2];
    const share = mesh.geometry.getAttribute("aShare").array[level];
    const [now, before] = [dataOf(mesh, "uPoses")[texel], dataOf(mesh, "uBefore")[texel]];
    return share < 1 ? before + (now - before) * share : now;
  };
  for (let frame = 1; frame <= 12; frame++) {
    nodes.setPoses(posesOf(frame), null);
    const { renderer, drawn } = recorder();
    nodes.render(renderer);
    // each pose is reached evenly, over a period from when it is taken; the first of them is that of the first frame
    PERIODS.forEach((period, level) => {
      const late = frame < period ? frame / period : frame - (period - 1);
      expect(shown(drawn[0], level), `frame ${frame}, level ${level}`).toBeCloseTo(late, 5);
    });
  }
});

test(`species take the poses of distant trees in different frames (seed ${SEED})`, () => {
  const next = random(SEED);
  const all = new TogetherNodes(MAX_SIDE, { value: 1 });
  const farthest = NODE_LEVEL_COUNT - 1;
  const period = PERIODS[farthest];
  const species = Array.from({ length: period }, () => drawnSpecies(all, next, 20));
  const taking: number[][] = [];
  for (let frame = 0; frame < 3 * period; frame++) {
    const before = species.map(({ nodes }) => nodes.shares[farthest]);
    for (const { nodes, poses } of species) nodes.setPoses(poses, null);
    taking.push(species.flatMap(({ nodes: { shares } }, k) => (shares[farthest] < before[k] ? [k] : [])));
    for (const { nodes } of species) expect(nodes.shares[0]).toBe(1);
  }
  expect(taking).toEqual(Array.from(taking, (_, frame) => [frame % period]));
});
