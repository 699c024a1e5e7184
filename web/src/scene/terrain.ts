/** The ground: a disc that is fine in the middle and coarse at the horizon, with leaf litter and meadow. */
import { BufferAttribute, BufferGeometry, Mesh, MeshStandardMaterial } from "three";
import { AIR_FRAGMENT, AIR_PARS, air } from "./air";
import { glade, groundHeight_m } from "./landscape";
import { NOISE_GLSL } from "./noiseGlsl";

const RINGS = 150;
const SECTORS = 192;
const REACH_M = 1700;

/** Ring radii grow slowly first: about 1 m apart in the middle, 60 m at the rim. */
const ringRadius_m = (ring: number) => REACH_M * (0.12 * (ring / RINGS) + 0.88 * (ring / RINGS) ** 4);

function discGeometry(): BufferGeometry {
  const columns = SECTORS + 1;
  const position = new Float32Array((RINGS + 1) * columns * 3);
  const meadow = new Float32Array((RINGS + 1) * columns);
  for (let ring = 0; ring <= RINGS; ring++) {
    for (let sector = 0; sector <= SECTORS; sector++) {
      const angle = (2 * Math.PI * sector) / SECTORS;
      const x = ringRadius_m(ring) * Math.cos(angle);
      const z = ringRadius_m(ring) * Math.sin(angle);
      const v = ring * columns + sector;
      position.set([x, groundHeight_m(x, z), z], v * 3);
      meadow[v] = glade(x, z);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("aMeadow", new BufferAttribute(meadow, 1));
  geometry.setIndex(new BufferAttribute(discIndex(columns), 1));
  geometry.computeVertexNormals();
  return geometry;
}

function discIndex(columns: number): Uint32Array {
  const index: number[] = [];
  for (let ring = 0; ring < RINGS; ring++) {
    for (let sector = 0; sector < SECTORS; sector++) {
      const a = ring * columns + sector;
      const b = a + columns;
      index.push(a, a + 1, b, b, a + 1, b + 1);
    }
  }
  return Uint32Array.from(index);
}

const GROUND_PARS = /* glsl */ `
varying vec3 vGround;
varying float vMeadow;
/** One scattering of fallen leaves: coverage of the leaf that lies in this cell, and its own random. */
vec2 fallenLeaf(vec2 place, float share) {
  ivec2 cell = ivec2(floor(place));
  float own = hashAt(cell);
  vec2 centre = 0.5 + 0.5 * (vec2(hashAt(cell + 91), hashAt(cell - 57)) - 0.5);
  float turn = 6.283 * own;
  vec2 off = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * (fract(place) - centre);
  float inside = 1.0 - smoothstep(0.16, 0.24, length(off * vec2(1.0, 1.7)));
  return vec2(inside * step(1.0 - share, hashAt(cell + 17)), fract(own * 7.7));
}
`;

const GROUND = /* glsl */ `
vec2 g = vGround.xz;
float away = length(vViewPosition);
float broad = fractalAt(g * 0.035);
float patchy = fractalAt(g * 0.19 + 31.0);
float fine = noiseAt(g * 2.7) * 0.5 + noiseAt(g * 7.1) * 0.3 + noiseAt(g * 19.0) * 0.2;
float close = exp(-away * 0.022);
vec3 litter = mix(vec3(0.34, 0.15, 0.04), vec3(0.47, 0.29, 0.07), smoothstep(0.3, 0.68, patchy));
litter = mix(litter, vec3(0.30, 0.27, 0.07), 0.75 * smoothstep(0.5, 0.75, broad));
vec3 grass = mix(vec3(0.25, 0.29, 0.06), vec3(0.46, 0.37, 0.10), smoothstep(0.3, 0.65, patchy * 0.6 + broad * 0.4));
float open = smoothstep(0.2, 0.8, vMeadow + 0.7 * (patchy - 0.5));
vec3 ground = mix(litter, grass, open);
ground *= 1.0 + close * (1.1 * fine - 0.55) + 0.35 * (patchy - 0.5);
for (int layer = 0; layer < 2; layer++) {
  float size = layer == 0 ? 3.1 : 6.3;
  vec2 leaf = fallenLeaf(g * size + float(layer) * 41.0, mix(0.55, 0.25, open));
  vec3 leafColour = leaf.y < 0.35 ? vec3(0.55, 0.07, 0.03) : (leaf.y < 0.7 ? vec3(0.72, 0.42, 0.06) : vec3(0.5, 0.2, 0.05));
  ground = mix(ground, leafColour * (0.65 + 0.5 * fine), leaf.x * 0.85 * exp(-away * 0.03));
}
float distant = smoothstep(150.0, 420.0, length(g));
float crowns = fractalAt(g * 0.13);
float hue = fractalAt(g * 0.03 + 3.0);
vec3 woods = mix(vec3(0.36, 0.27, 0.06), vec3(0.42, 0.15, 0.04), smoothstep(0.42, 0.56, hue));
woods = mix(woods, vec3(0.2, 0.24, 0.06), smoothstep(0.52, 0.68, fractalAt(g * 0.021 + 17.0)));
ground = mix(ground, woods * (0.35 + 1.5 * crowns * crowns), distant);
diffuseColor.rgb = ground;
`;

function groundMaterial(): MeshStandardMaterial {
  const material = new MeshStandardMaterial({ roughness: 1, metalness: 0 });
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, air);
    const varyings = "attribute float aMeadow;\nvarying vec3 vGround;\nvarying float vMeadow;";
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${varyings}`)
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvGround = position;\nvMeadow = aMeadow;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>\n${AIR_PARS}${NOISE_GLSL}${GROUND_PARS}`)
      .replace("#include <map_fragment>", GROUND)
      .replace("#include <fog_fragment>", AIR_FRAGMENT);
  };
  material.customProgramCacheKey = () => "galewood-ground";
  return material;
}

export class Terrain {
  readonly mesh = new Mesh(discGeometry(), groundMaterial());

  constructor() {
    this.mesh.receiveShadow = true;
    this.mesh.matrixAutoUpdate = false;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
