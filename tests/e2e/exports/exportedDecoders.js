/** Runs the exported decoders on the graphics card and reads back where they move the vertices: part of the page of
 * exports.spec.ts, with three.js from an import map. */
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Camera,
  DirectionalLight,
  FloatType,
  Matrix4,
  NearestFilter,
  OrthographicCamera,
  Points,
  PointsMaterial,
  RawShaderMaterial,
  Scene,
  GLSL3,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { loadTextures, loadVat, vatInstances, vatMaterial } from "./vat/galewoodVat.js";

const SIDE = 128;
const TO_PIXEL = `gl_Position = vec4((vec2(float(gl_VertexID % ${SIDE}), float(gl_VertexID / ${SIDE})) + 0.5)
  / ${SIDE}.0 * 2.0 - 1.0, 0.0, 1.0); gl_PointSize = 1.0;`;
const renderer = new WebGLRenderer();

/** Draws every vertex as a pixel whose colour is its place, and reads the places back. */
function places(geometry, material) {
  const target = new WebGLRenderTarget(SIDE, SIDE, {
    type: FloatType,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthBuffer: false,
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  const scene = new Scene();
  scene.add(points);
  renderer.setRenderTarget(target);
  renderer.render(scene, new Camera());
  const pixels = new Float32Array(4 * SIDE * SIDE);
  renderer.readRenderTargetPixels(target, 0, 0, SIDE, SIDE, pixels);
  return pixels;
}

function geometryOf(expected, mirrored) {
  const rest = Float32Array.from(expected.rest, (value, k) => (mirrored && k % 3 === 0 ? -value : value));
  const texel = Float32Array.from(expected.texel, (value, k) => (mirrored && k % 2 === 1 ? 1 - value : value));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(rest, 3));
  geometry.setAttribute("vatTexel", new BufferAttribute(texel, 2));
  return geometry;
}

/** The largest distance from where the table draws the vertices, in % of the height. */
function percent(pixels, expected, mirrored) {
  let worst = 0;
  for (let vertex = 0; vertex < expected.drawn.length / 3; vertex++) {
    const [x, y, z] = expected.drawn.slice(3 * vertex, 3 * vertex + 3);
    const place = pixels.slice(4 * vertex, 4 * vertex + 3);
    const apart = Math.hypot(place[0] - (mirrored ? -x : x), place[1] - y, place[2] - z);
    worst = Math.max(worst, Number.isFinite(apart) ? apart : 1e9);
  }
  return (100 * worst) / expected.height_m;
}

/** The three.js module, in a built-in material; `start`: the share of the loop by which an instance is ahead. */
function byThree(expected, vat, start = 0) {
  const geometry = geometryOf(expected);
  const ahead = new Float32Array(expected.rest.length / 3).fill(start);
  if (start) geometry.setAttribute("vatStart", new BufferAttribute(ahead, 1));
  vat.uniforms.vatTime.value = expected.time_s - (start * vat.uniforms.vatFrames.value) / vat.uniforms.vatFps.value;
  const material = vatMaterial(new PointsMaterial(), vat, { start: start > 0 });
  const patch = material.onBeforeCompile;
  material.onBeforeCompile = (shader) => {
    patch(shader);
    const vertex = shader.vertexShader.replace("#include <common>", "#include <common>\nvarying vec3 place;");
    shader.vertexShader = vertex.replace(/}\s*$/, `place = transformed; ${TO_PIXEL} }`);
    shader.fragmentShader = "varying vec3 place; void main() { gl_FragColor = vec4(place, 1.0); }";
  };
  return percent(places(geometry, material), expected);
}

function raw(expected, vat, vertexShader, mirrored) {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    uniforms: {
      offset_map: vat.uniforms.vatOffsetMap,
      rotation_map: vat.uniforms.vatRotationMap,
      pivot_map: vat.uniforms.vatPivotMap,
    },
    vertexShader: `precision highp float; precision highp int; precision highp sampler2D;
      in vec3 position; in vec2 vatTexel; out vec3 place; ${vertexShader}`,
    fragmentShader: `precision highp float; in vec3 place; out vec4 colour;
      void main() { colour = vec4(place, 1.0); }`,
  });
  return percent(places(geometryOf(expected, mirrored), material), expected, mirrored);
}

/** The vertex function of the Godot shader: its language is GLSL but for hints and names of inputs and outputs. */
async function byGodot(expected, vat) {
  const source = await (await fetch("./vat/tree.gdshader")).text();
  const code = source
    .slice(source.indexOf("uniform"), source.indexOf("void fragment()"))
    .replace(/uniform (sampler2D \w+_map) :[^;]*;/g, "uniform $1;")
    .replace(/uniform vec4 albedo[^;]*;/, "")
    .replace(/uniform ((?:float|int|vec3) \w+ =)/g, "$1")
    .replace("void vertex()", "void godotVertex()");
  return raw(
    expected,
    vat,
    `vec3 VERTEX, NORMAL, TANGENT, BINORMAL; vec2 UV2; float TIME; mat4 MODEL_MATRIX;
    ${code}
    void main() {
      VERTEX = position; UV2 = vatTexel; TIME = ${expected.time_s}; MODEL_MATRIX = mat4(1.0);
      godotVertex();
      place = VERTEX; ${TO_PIXEL}
    }`,
  );
}

/** The function for Unity: written so that few words tell it from GLSL. The tree is mirrored, as glTFast does it, and
 * the rows of the textures begin at the bottom, as Unity's do. */
async function byUnity(expected, description) {
  const source = await (await fetch("./vat/tree.hlsl")).text();
  const code = source
    .replace(/#(ifndef|define|endif).*/g, "")
    .replace(/\bfloat([234])\b/g, "vec$1")
    .replace(/\bint3\b/g, "ivec3")
    .replace(/\blerp\b/g, "mix")
    .replace(/\bfrac\b/g, "fract")
    .replace(/\bUnityTexture2D\b/g, "sampler2D")
    .replace(/(\w+)\.tex\.GetDimensions\((\w+), (\w+)\)/g, "$2 = uint(textureSize($1, 0).x); $3 = uint(textureSize($1, 0).y)")
    .replace(/(\w+)\.tex\.Load\((\w)\)/g, "texelFetch($1, $2.xy, 0)");
  const vat = await loadTextures(description, new URL("./vat/tree.json", location.href));
  for (const use of ["Offset", "Rotation", "Pivot"]) upsideDown(vat.uniforms[`vat${use}Map`].value);
  return raw(
    expected,
    vat,
    `uniform sampler2D offset_map; uniform sampler2D rotation_map; uniform sampler2D pivot_map;
    ${code}
    void main() {
      vec3 normal, tangent;
      GalewoodVat_float(position, vec3(0.0, 1.0, 0.0), vec3(1.0, 0.0, 0.0), vatTexel, ${expected.time_s}, 0.0,
        offset_map, rotation_map, pivot_map, place, normal, tangent);
      ${TO_PIXEL}
    }`,
    true,
  );
}

function upsideDown(texture) {
  const { data, width, height } = texture.image;
  const line = (data.length / (width * height)) * width;
  const turned = data.slice();
  for (let row = 0; row < height; row++) turned.set(data.subarray(row * line, (row + 1) * line), (height - 1 - row) * line);
  texture.image.data = turned;
}

/** Draws an object with its own materials, in light with shadows; returns how many pixels are not background. */
function drawn(tree, object) {
  const light = new DirectionalLight(0xffffff, 3);
  light.position.set(10, 20, 10);
  light.castShadow = true;
  const scene = new Scene();
  scene.add(light, new AmbientLight(0xffffff, 1), object);
  object.traverse((mesh) => {
    mesh.castShadow = mesh.receiveShadow = true;
  });
  const { low, high } = tree.description.bounds_m;
  const camera = new OrthographicCamera(low[0], high[0], high[1], low[1], 0, 100);
  camera.position.z = 50;
  renderer.shadowMap.enabled = true;
  const target = new WebGLRenderTarget(SIDE, SIDE);
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const pixels = new Uint8Array(4 * SIDE * SIDE);
  renderer.readRenderTargetPixels(target, 0, 0, SIDE, SIDE, pixels);
  return pixels.filter((value, k) => k % 4 === 1 && value > 0).length;
}

const expected = await (await fetch("./expected.json")).json();
const tree = await loadVat("./vat/tree.json");
const still = 100 * Math.max(...expected.drawn.map((value, k) => Math.abs(value - expected.rest[k])));
window.decoded = {
  three: byThree(expected, tree.vat),
  instance: byThree(expected, tree.vat, 0.25),
  godot: await byGodot(expected, tree.vat),
  unity: await byUnity(expected, tree.description),
  sway: still / expected.height_m,
  pixels: drawn(tree, tree.object),
  instances: drawn(tree, vatInstances(tree, [new Matrix4(), new Matrix4().setPosition(2, 0, 0)], [0, 0.5])),
  meshes: tree.object.children.length,
};
