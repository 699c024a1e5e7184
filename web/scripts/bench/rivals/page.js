/**
 * One view of one forest, drawn in three ways: by the package, whose trees move on their own; by `InstancedMesh`es of three.js,
 * which stand still; and by the same with morph targets of the first two modes and weights of each tree. The rivals draw the same
 * triangles of the same trees at the same levels of detail, which the package has selected for them.
 */
import { jointsOf, NodePose, PRESETS, readTable } from "galewood/core";
import { Forest } from "galewood/three";
import * as THREE from "three";

const TREE_FILES = { table: "/trees/poplar.table", mesh: "/light/poplar.glb" };
const SPACING_M = 7;
/** Frames after which the worker has sent poses, and the trees have their levels of detail. */
const WARM_FRAMES = 8;
/** Sway of the morphing rivals, in the units of the modes, and its two frequencies. */
const SWAY_WEIGHT = 0.3;
const SWAY_RATES_HZ = [0.45, 0.6];

const renderer = new THREE.WebGLRenderer({ antialias: false });
renderer.setSize(480, 270);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(46, 480 / 270, 0.3, 2000);
camera.position.set(0, 6, 0);
camera.lookAt(60, 8, 60);
camera.updateMatrixWorld();

function sceneOf(...objects) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xbcd6ea);
  const sun = new THREE.DirectionalLight(0xfff1d6, 3);
  sun.position.set(4, 5, 3);
  scene.add(sun, new THREE.HemisphereLight(0xcfe4ff, 0x6d7a4a, 2.2), ...objects);
  return scene;
}

function placesOf(count) {
  const side = Math.ceil(Math.sqrt(count));
  return Array.from({ length: count }, (_, k) => {
    const [row, column] = [Math.floor(k / side), k % side];
    const spot = new THREE.Vector3(
      (row - side / 2 + 0.3) * SPACING_M,
      0,
      (column - side / 2 + 0.3) * SPACING_M,
    );
    const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 1, 0), 2.4 * k);
    return new THREE.Matrix4().compose(spot, turn, new THREE.Vector3(1, 1, 1));
  });
}

/** Displacements (v · 3) of the vertices of each part by the first two modes, from the table. */
function modesOf(table, parts) {
  const pose = new NodePose(jointsOf(table));
  const out = new Float64Array(3);
  let first = 0;
  return parts.map((rest) => {
    const targets = [0, 1].map((mode) => {
      pose.take(
        Float32Array.from({ length: table.metadata.modes }, (_, k) => (k === mode ? 1 : 0)),
        0,
      );
      const moved = new Float32Array(3 * rest.count);
      for (let v = 0; v < rest.count; v++) {
        const at = [rest.getX(v), rest.getY(v), rest.getZ(v)];
        pose.place(first + v, ...at, out);
        for (let axis = 0; axis < 3; axis++) moved[3 * v + axis] = out[axis] - at[axis];
      }
      return moved;
    });
    first += rest.count;
    return targets;
  });
}

/** What three.js draws of a mesh of the package, as `InstancedMesh`. */
function rivalOf(mesh, count, modes, matrixAt) {
  const geometry = new THREE.BufferGeometry();
  const { start, count: indices } = mesh.geometry.drawRange;
  geometry.setIndex(mesh.geometry.index);
  geometry.setDrawRange(start, indices);
  for (const name of ["position", "normal", "uv", "color"])
    if (mesh.geometry.attributes[name]) geometry.setAttribute(name, mesh.geometry.attributes[name]);
  const { map, alphaTest, side, vertexColors } = mesh.material;
  const rival = new THREE.InstancedMesh(
    geometry,
    new THREE.MeshLambertMaterial({ map, alphaTest, side, vertexColors }),
    count,
  );
  if (modes) {
    geometry.morphAttributes.position = modes.map((moved) => new THREE.BufferAttribute(moved, 3));
    geometry.morphTargetsRelative = true;
    rival.updateMorphTargets();
  }
  rival.frustumCulled = false;
  const { data } = mesh.geometry.attributes.aPlace;
  for (let k = 0; k < count; k++) rival.setMatrixAt(k, matrixAt(data.array, k * data.stride));
  return rival;
}

/** Weights of all trees at a time, as a program would set them that knows a frequency and nothing else. */
function sway(rivals, time_s) {
  const weights = { morphTargetInfluences: [0, 0] };
  for (const rival of rivals) {
    for (let k = 0; k < rival.count; k++) {
      for (let mode = 0; mode < 2; mode++)
        weights.morphTargetInfluences[mode] =
          SWAY_WEIGHT * Math.sin(6.283 * SWAY_RATES_HZ[mode] * time_s + k);
      rival.setMorphAt(k, weights);
    }
    rival.morphTexture.needsUpdate = true;
  }
}

const keyOf = (x_m, z_m) => `${x_m} ${z_m}`;
const next = () => new Promise(requestAnimationFrame);

/** Prepares the three ways; returns their names. */
window.prepare = async (trees) => {
  const places = placesOf(trees);
  const forest = new Forest({ wind: PRESETS["autumn-gusts"], shadow_m: 0 });
  const table = readTable(await (await fetch(TREE_FILES.table)).arrayBuffer());
  await forest.plant(TREE_FILES, places);
  const scene = sceneOf(forest);
  for (let frame = 0; frame < WARM_FRAMES; frame++) {
    forest.update(1 / 30, camera);
    renderer.render(scene, camera);
    await next();
  }
  const parts = [];
  const drawn = [];
  forest.traverse((mesh) => {
    if (!mesh.isMesh || mesh.castShadow) return;
    const { position } = mesh.geometry.attributes;
    if (!parts.includes(position)) parts.push(position);
    if (mesh.visible && mesh.material.visible) drawn.push({ mesh, part: parts.indexOf(position) });
  });
  const modes = modesOf(table, parts);
  const rounded = new Map(
    places.map((matrix) => [
      keyOf(Math.fround(matrix.elements[12]), Math.fround(matrix.elements[14])),
      matrix,
    ]),
  );
  const matrixAt = (array, at) => rounded.get(keyOf(array[at], array[at + 2]));
  const rivals = (of) =>
    drawn.map(({ mesh, part }) => rivalOf(mesh, mesh.geometry.instanceCount, of && modes[part], matrixAt));
  const [still, morphed] = [rivals(false), rivals(true)];
  const scenes = { package: scene, still: sceneOf(...still), morphed: sceneOf(...morphed) };
  let time_s = 1;
  const frames = {
    package: () => forest.update(1 / 60, camera),
    still: () => {},
    morphed: () => sway(morphed, time_s),
  };
  window.drawOne = (way) => {
    time_s += 1 / 60;
    frames[way]();
    renderer.render(scenes[way], camera);
  };
  for (const way of Object.keys(scenes)) window.drawOne(way);
  finished_ms();
  return {
    trees: drawn
      .filter(({ part }) => part === 0)
      .reduce((sum, { mesh }) => sum + mesh.geometry.instanceCount, 0),
    triangles: renderer.info.render.triangles,
  };
};

/** Time when the graphics have finished all that has been drawn: reading a pixel waits for it. */
function finished_ms() {
  const gl = renderer.getContext();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  return performance.now();
}

/** Draws frames in one way; returns the mean time of a frame, ms. */
window.draw = async (way, count) => {
  await next();
  const begin_ms = finished_ms();
  for (let frame = 0; frame < count; frame++) {
    await next();
    window.drawOne(way);
    finished_ms();
  }
  return (finished_ms() - begin_ms) / count;
};
