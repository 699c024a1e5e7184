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

const GROUND = /* glsl */ `
vec2 g = vGround.xz;
float broad = fractalAt(g * 0.035);
float patchy = fractalAt(g * 0.21 + 31.0);
float fine = fractalAt(g * 1.9 + 5.0);
float near = exp(-length(vViewPosition) * 0.03);
vec3 litter = mix(vec3(0.30, 0.135, 0.035), vec3(0.42, 0.24, 0.05), smoothstep(0.3, 0.7, patchy));
vec3 grass = mix(vec3(0.27, 0.25, 0.05), vec3(0.40, 0.31, 0.075), smoothstep(0.25, 0.7, broad));
float open = smoothstep(0.25, 0.75, vMeadow + 0.5 * (patchy - 0.5));
vec3 ground = mix(litter, grass, open);
ground *= 0.72 + 0.56 * fine;
ivec2 cell = ivec2(floor(g * 5.5));
vec2 within = fract(g * 5.5) - 0.5 - 0.5 * (vec2(hashAt(cell + 91), hashAt(cell - 57)) - 0.5);
float fallen = step(length(within * vec2(1.0, 1.5 + hashAt(cell))), 0.2) * step(0.5 + 0.3 * open, hashAt(cell + 17));
vec3 leafColour = mix(vec3(0.55, 0.10, 0.02), vec3(0.68, 0.42, 0.05), hashAt(cell + 5));
ground = mix(ground, leafColour * (0.5 + 0.6 * fine), 0.8 * near * fallen);
float far = smoothstep(180.0, 480.0, length(g));
vec3 woods = mix(vec3(0.24, 0.19, 0.05), vec3(0.36, 0.14, 0.035), smoothstep(0.42, 0.62, fractalAt(g * 0.05 + 3.0)));
woods *= 0.55 + 0.9 * fractalAt(g * 0.12);
ground = mix(ground, woods, far);
diffuseColor.rgb = ground;
`;

function groundMaterial(): MeshStandardMaterial {
  const material = new MeshStandardMaterial({ roughness: 1, metalness: 0 });
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, air);
    shader.vertexShader = shader.vertexShader
      .replace(
        "#include <common>",
        "#include <common>\nattribute float aMeadow;\nvarying vec3 vGround;\nvarying float vMeadow;",
      )
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvGround = position;\nvMeadow = aMeadow;");
    shader.fragmentShader = shader.fragmentShader
      .replace(
        "#include <common>",
        `#include <common>\nvarying vec3 vGround;\nvarying float vMeadow;\n${AIR_PARS}${NOISE_GLSL}`,
      )
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
