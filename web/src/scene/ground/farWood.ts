/** Static background forest beyond the simulated trees, made of cards that face the camera. */
import {
  BufferAttribute,
  Color,
  DataTexture,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LinearFilter,
  LinearMipmapLinearFilter,
  Mesh,
  NoColorSpace,
  ShaderMaterial,
} from "three";
import { hashUnit } from "../../core/math/random";
import { HEART } from "../placement";
import type { Quality } from "../quality";
import { leafTint } from "../season/palette";
import type { Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_PARS, air } from "../sky/air";
import type { Atmosphere } from "../sky/daytime";
import { CARD_SHAPES, paintCards } from "../textures/cardPictures";
import { glade, groundHeight_m } from "./landscape";

const SPACING_M: Record<Quality, number> = { low: 17, medium: 12, high: 9.5 };
const REACH_M = 430;
/** Gap between the outermost simulated trees and the first cards. */
const GAP_M = 3;
const SPECIES = ["poplar", "maple", "apricot"] as const;
const HEIGHT_M = [15, 13, 8.5] as const;

const vertexShader = /* glsl */ `
attribute vec4 aTree; // x, y, z, height in m
attribute vec4 aLook; // leaf colour; shape
uniform float uBare;
varying vec2 vAt;
varying vec3 vTint;
varying vec3 vWorld;
varying vec3 vOut;
void main() {
  vec3 eyeward = normalize(vec3(cameraPosition.x - aTree.x, 0.0, cameraPosition.z - aTree.z));
  vec3 right = vec3(eyeward.z, 0.0, -eyeward.x);
  vWorld = aTree.xyz + aTree.w * (right * position.x + vec3(0.0, position.y, 0.0));
  vOut = 1.7 * right * position.x + vec3(0.0, 1.5 * (position.y - 0.45), 0.0) + 0.45 * eyeward;
  vAt = vec2((aLook.w + position.x + 0.5) / ${CARD_SHAPES.toFixed(1)}, 0.5 * (position.y * 0.99 + uBare));
  vTint = aLook.rgb;
  gl_Position = projectionMatrix * viewMatrix * vec4(vWorld, 1.0);
}
`;

const fragmentShader = /* glsl */ `
uniform sampler2D uCards;
uniform float uBare;
uniform vec3 uSunLight;
uniform vec3 uSkyLight;
uniform float uSnow;
uniform vec3 uSnowColour;
varying vec2 vAt;
varying vec3 vTint;
varying vec3 vWorld;
varying vec3 vOut;
${AIR_PARS}
void main() {
  vec4 card = texture2D(uCards, vAt);
  vec2 span = vec2(length(dFdx(vAt)), length(dFdy(vAt))) * vec2(textureSize(uCards, 0));
  // Restore the coverage of bare twigs, which mip levels reduce; full crowns keep their ragged edge.
  if (card.a * (1.0 + mix(0.03, 0.3, uBare) * max(0.0, log2(max(span.x, span.y)))) < 0.45) discard;
  vec3 own = card.rgb / max(card.a, 0.2);
  vec3 albedo = mix(vTint * (0.08 + 0.78 * own.r), vec3(0.11, 0.085, 0.065), own.g);
  albedo = mix(albedo, uSnowColour, 0.4 * uSnow);
  vec3 out_ = normalize(vOut);
  float facing = dot(out_, uSunWorld);
  float through = 0.25 * max(0.0, -facing);
  vec3 light = uSunLight * (max(0.0, 0.75 * facing + 0.2) + through) + uSkyLight * (0.55 + 0.45 * out_.y);
  vec3 away = vWorld - cameraPosition;
  float distance_m = length(away);
  gl_FragColor = vec4(throughAir(albedo * light * 0.3183, away / distance_m, distance_m), 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;

export class FarWood {
  readonly mesh: Mesh<InstancedBufferGeometry, ShaderMaterial>;
  private readonly texture: DataTexture;
  private season: Season = "autumn";
  private populatedKey = "";

  constructor() {
    const { width, height, pixels } = paintCards();
    this.texture = new DataTexture(pixels, width, height);
    this.texture.colorSpace = NoColorSpace;
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    this.texture.generateMipmaps = true;
    this.texture.needsUpdate = true;
    const material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      uniforms: {
        ...air,
        ...seasonal,
        uCards: { value: this.texture },
        uBare: { value: 0 },
        uSunLight: { value: new Color() },
        uSkyLight: { value: new Color() },
      },
    });
    this.mesh = new Mesh(new InstancedBufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 4; // behind the trees, before the ground
    this.mesh.visible = false;
  }

  /** Places the cards around a forest of this radius. */
  populate(from_m: number, quality: Quality): void {
    const key = `${Math.round(from_m)} ${quality}`;
    if (key === this.populatedKey) return;
    this.populatedKey = key;
    const spacing_m = SPACING_M[quality];
    const cells = Math.ceil((REACH_M + Math.hypot(HEART.x_m, HEART.z_m)) / spacing_m);
    const trees: number[] = [];
    const looks: number[] = [];
    for (let row = -cells; row <= cells; row++) {
      for (let column = -cells; column <= cells; column++) {
        const tree = this.candidate(column, row, spacing_m, from_m);
        if (!tree) continue;
        trees.push(...tree);
        looks.push(0, 0, 0, Math.floor(CARD_SHAPES * hashUnit(97, column, row)));
      }
    }
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometryOf(Float32Array.from(trees), Float32Array.from(looks));
    this.mesh.visible = trees.length > 0;
    this.tint();
  }

  private candidate(column: number, row: number, spacing_m: number, from_m: number): number[] | null {
    const at = (channel: number) => hashUnit(95, column, row, channel);
    const x = (column + at(0)) * spacing_m;
    const z = (row + at(1)) * spacing_m;
    const out_m = Math.hypot(x - HEART.x_m, z - HEART.z_m);
    if (out_m < from_m + GAP_M || out_m > REACH_M || glade(x, z) > 0.4) return null;
    const shape = Math.floor(CARD_SHAPES * hashUnit(97, column, row));
    return [x, groundHeight_m(x, z) - 0.4, z, HEIGHT_M[shape] * (0.75 + 0.5 * at(2))];
  }

  private tint(): void {
    const look = this.mesh.geometry.getAttribute("aLook");
    if (!look) return;
    for (let i = 0; i < look.count; i++) {
      const [r, g, b] = leafTint(SPECIES[look.getW(i)], i, this.season);
      look.setXYZ(i, r, g, b);
    }
    look.needsUpdate = true;
  }

  show({ sunlight, skylight }: Atmosphere, season: Season): void {
    const { uniforms } = this.mesh.material;
    uniforms.uSunLight.value.setRGB(...sunlight);
    uniforms.uSkyLight.value.setRGB(...skylight);
    uniforms.uBare.value = season === "winter" ? 1 : 0;
    if (season === this.season) return;
    this.season = season;
    this.tint();
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.texture.dispose();
  }
}

function geometryOf(trees: Float32Array, looks: Float32Array): InstancedBufferGeometry {
  const geometry = new InstancedBufferGeometry();
  const corners = Float32Array.from([-0.5, 0, 0, 0.5, 0, 0, 0.5, 1, 0, -0.5, 1, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.setAttribute("aTree", new InstancedBufferAttribute(trees, 4));
  geometry.setAttribute("aLook", new InstancedBufferAttribute(looks, 4));
  geometry.instanceCount = trees.length / 4;
  return geometry;
}
