/**
 * Draws the same trees at the same time by one of three renderers (`?webgl`, `?webgpu`, `?webgpu-webgl`: WebGPURenderer on
 * WebGL 2), and reports the picture and, for materials of nodes, where the vertices are drawn compared with galewood/core.
 */
import {
  Color,
  DirectionalLight,
  Euler,
  HemisphereLight,
  InstancedBufferGeometry,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  Points,
  Quaternion,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { float, Fn, floor, positionLocal, vec2, vec4, vertexIndex } from "three/tsl";
import { FloatType, NearestFilter, NodeMaterial, NoBlending, RenderTarget, WebGPURenderer } from "three/webgpu";
import { createForest, PRESETS, readTable } from "galewood/core";
import * as classic from "galewood/three";
import * as nodes from "galewood/webgpu";

const kind = location.search.slice(1);
const files = { table: "/trees/poplar-forest.table", mesh: "/trees/poplar-forest.glb" };
const wind = PRESETS["storm-front"];
/** Turned and larger, upright, and tilted: what the wind does to each depends on place, yaw and scale only. */
const places = [
  { x_m: -7, z_m: -3, yaw_rad: 1, scale: 1.2, tilt_rad: 0 },
  { x_m: 0, z_m: 0, yaw_rad: 0, scale: 1, tilt_rad: 0 },
  { x_m: 7, z_m: -3, yaw_rad: 0, scale: 1, tilt_rad: 0.2 },
];
const matrixOf = ({ x_m, z_m, yaw_rad, scale, tilt_rad }) =>
  new Matrix4().compose(
    new Vector3(x_m, 0, z_m),
    new Quaternion().setFromEuler(new Euler(0, yaw_rad, tilt_rad)),
    new Vector3(scale, scale, scale),
  );
const STEP_S = 1 / 30;
const STEPS = 60;

const renderer =
  kind === "webgl"
    ? new WebGLRenderer({ antialias: true })
    : new WebGPURenderer({ antialias: true, forceWebGL: kind === "webgpu-webgl" });
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = PCFShadowMap;
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
await renderer.init?.();

const camera = new PerspectiveCamera(46, innerWidth / innerHeight, 0.3, 400);
camera.position.set(4, 4, 26);
camera.lookAt(0, 6, 0);
const scene = new Scene();
scene.background = new Color(0xbcd6ea);
const sun = new DirectionalLight(0xfff1d6, 3);
sun.position.set(14, 22, 12);
sun.castShadow = true;
Object.assign(sun.shadow.camera, { left: -22, right: 22, top: 22, bottom: -22, far: 80 });
sun.shadow.bias = -0.002;
sun.shadow.mapSize.set(1024, 1024);
const meadow = new Mesh(new PlaneGeometry(400, 400), new MeshLambertMaterial({ color: 0x7f9a52 }));
meadow.rotation.x = -Math.PI / 2;
meadow.receiveShadow = true;
scene.add(sun, meadow, new HemisphereLight(0xcfe4ff, 0x6d7a4a, 2.2));

const forest = new (kind === "webgl" ? classic : nodes).Forest({ wind });
scene.add(forest);
scene.updateMatrixWorld();
for (const place of places) await forest.plant(files, [matrixOf(place)]);

/** Advances the motion of the worker step by step, so that every renderer gets the same. */
for (let step = 1; step <= STEPS; step++) {
  forest.update(STEP_S, camera);
  while (forest.time_s < (step - 0.5) * STEP_S) await new Promise((done) => setTimeout(done));
}
forest.update(0, camera); // takes the newest poses

/** Draws until nothing is loaded any more; returns the last picture. */
async function picture() {
  renderer.render(scene, camera);
  await new Promise((done) => setTimeout(done, 500)); // shaders and pictures of the mesh
  renderer.render(scene, camera);
  return renderer.domElement.toDataURL();
}

const WIDTH = 256;
/** Positions of all vertices of a mesh in the frame of the forest, by their index: each is drawn into a pixel of its own. */
async function drawnVertices({ geometry, material }) {
  const count = geometry.getAttribute("position").count;
  const height = Math.ceil(count / WIDTH);
  const target = new RenderTarget(WIDTH, height, {
    type: FloatType,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthBuffer: false,
  });
  const points = new InstancedBufferGeometry();
  for (const [name, attribute] of Object.entries(geometry.attributes)) points.setAttribute(name, attribute);
  points.instanceCount = 1;
  const own = new NodeMaterial();
  own.positionNode = material.positionNode;
  own.vertexNode = Fn(() => {
    const row = floor(float(vertexIndex).div(WIDTH).add(1e-4)).toVar();
    const at = vec2(float(vertexIndex).sub(row.mul(WIDTH)), row).add(0.5);
    return vec4(at.div(vec2(WIDTH, height)).mul(2).sub(1), 0, 1);
  })();
  own.fragmentNode = vec4(positionLocal, float(vertexIndex).toVarying().add(1));
  own.depthTest = false;
  own.blending = NoBlending;
  const drawn = new Points(points, own);
  drawn.frustumCulled = false;
  renderer.setRenderTarget(target);
  renderer.clear();
  renderer.render(drawn, camera);
  renderer.setRenderTarget(null);
  const pixels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, WIDTH, height);
  const found = new Float32Array(3 * count);
  const seen = new Set();
  for (let i = 0; i < WIDTH * height; i++) {
    const vertex = Math.round(pixels[4 * i + 3]) - 1;
    if (vertex < 0 || vertex >= count) continue;
    seen.add(vertex);
    for (let axis = 0; axis < 3; axis++) found[3 * vertex + axis] = pixels[4 * i + axis];
  }
  if (seen.size !== count) throw new Error(`read ${seen.size} of ${count} vertices`);
  return found;
}

/** Largest distance between vertices as drawn and as the table says, and how far these moved, over the height. */
async function compared() {
  const table = readTable(await (await fetch(files.table)).arrayBuffer());
  const { height_m } = table.metadata;
  const reference = createForest({ kinds: [{ table, places }], wind });
  for (let step = 1; step <= STEPS; step++) reference.step(STEP_S);
  forest.flutter = 0;
  renderer.render(scene, camera);
  const report = { vertices: 0, worst: 0, moved: 0 };
  for (const [tree, place] of places.entries()) {
    const matrix = matrixOf(place);
    const size_m = height_m * place.scale;
    // Of each level, the finest first, and of each part: for the colours, then for the shadows.
    const meshes = forest.planted[tree].trees.group.children;
    for (let first = 0, k = 0; first < table.vertexJoint.length; k += 2) {
      const rest = meshes[k].geometry.getAttribute("position").array;
      const expected = reference.vertices(tree, rest, undefined, first);
      const drawn = await drawnVertices(meshes[k]);
      const [wanted, found, still] = [new Vector3(), new Vector3(), new Vector3()];
      for (let v = 0; v < rest.length; v += 3) {
        wanted.fromArray(expected, v).applyMatrix4(matrix);
        found.fromArray(drawn, v);
        still.fromArray(rest, v).applyMatrix4(matrix);
        report.worst = Math.max(report.worst, wanted.distanceTo(found) / size_m);
        report.moved = Math.max(report.moved, wanted.distanceTo(still) / size_m);
      }
      report.vertices += rest.length / 3;
      first += rest.length / 3;
    }
  }
  return report;
}

const backend = renderer.backend?.isWebGPUBackend ? "WebGPU" : "WebGL";
const drawn = await picture();
window.drawn = { backend, picture: drawn, vertices: kind === "webgl" ? null : await compared() };
