/** Low plants, stones, dead wood and fallen leaves around the camera: one draw call for each kind. Plants bend with the wind. */
import {
  DoubleSide,
  FrontSide,
  Group,
  type Material,
  Mesh,
  MeshDepthMaterial,
  MeshLambertMaterial,
  RGBADepthPacking,
  type Texture,
  Vector3,
  type WebGLProgramParametersWithUniforms,
} from "three";
import type { Quality } from "../quality";
import { undergrowthTint } from "../season/palette";
import type { Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { AIR_FRAGMENT, AIR_PARS, air } from "../sky/air";
import type { Crowns } from "../sky/exposure";
import type { GroundWind } from "./groundWind";
import { groundHeight_m, slopeAt } from "./landscape";
import { PlantField } from "./plantField";
import { KIND_LOOKS, PLANT_KINDS, type PlantKind, seenIn } from "./plantKinds";
import { Trunks } from "./trunks";
import {
  COLOUR_GLSL,
  definesOf,
  FRAGMENT_PARS,
  LIGHT_GLSL,
  NORMAL_FRAGMENT_GLSL,
  NORMAL_GLSL,
  POSITION_GLSL,
  SHADOW_GLSL,
  SPIN_GLSL,
  VERTEX_PARS,
} from "./undergrowthShader";

interface Layer {
  readonly kind: PlantKind;
  readonly field: PlantField;
  readonly mesh: Mesh<PlantField["geometry"], MeshLambertMaterial> & { customDepthMaterial?: Material };
  readonly reach: { value: number };
}

export class Undergrowth {
  readonly group = new Group();
  private layers: Layer[] = [];
  private trunks = new Trunks(new Float32Array(0));
  private season: Season = "autumn";
  private readonly shared = {
    uSeconds: { value: 0 },
    uEye: { value: new Vector3() },
    uBare: { value: 0 },
  };

  constructor(
    private quality: Quality,
    private readonly pictures: { readonly plants: Texture; readonly noise: Texture },
    private readonly wind: GroundWind,
  ) {}

  setQuality(quality: Quality): void {
    if (quality === this.quality) return;
    this.quality = quality;
    this.clear();
  }

  private grow(): void {
    this.layers = PLANT_KINDS.flatMap((kind) => this.layer(kind));
    this.group.add(...this.layers.map(({ mesh }) => mesh));
    this.dress();
  }

  private layer(kind: PlantKind): Layer[] {
    const { quality } = this;
    const { shape, cells, castsShadow } = KIND_LOOKS[kind];
    const own = cells[quality];
    if (!own) return [];
    const [side, spacing_m] = own;
    const field = new PlantField(shape(), side, spacing_m, (out, at, column, row) =>
      this.write(kind, spacing_m, out, at, column, row),
    );
    const reach = { value: field.reach_m };
    const mesh: Layer["mesh"] = new Mesh(field.geometry, this.material(kind, reach));
    mesh.frustumCulled = false;
    mesh.receiveShadow = true;
    mesh.renderOrder = 6;
    if (castsShadow && quality !== "low") {
      mesh.castShadow = true;
      mesh.customDepthMaterial = this.shadowMaterial(kind, reach);
    }
    return [{ kind, field, mesh, reach }];
  }

  private write(
    kind: PlantKind,
    spacing_m: number,
    out: Float32Array,
    at: number,
    column: number,
    row: number,
  ): void {
    const { season, trunks } = this;
    const { at: place, sunk, tint } = KIND_LOOKS[kind];
    const { x, z, size_m, hue, turn, crown = -1 } = place(column, row, spacing_m, trunks, season);
    if (size_m === 0) {
      out.fill(0, at, at + 8);
      return;
    }
    const y = groundHeight_m(x, z) - sunk[0] * size_m - sunk[1];
    const colour = crown < 0 ? null : trunks.crownOf(crown).colour;
    const look = tint ? undergrowthTint(tint, hue, season, colour) : [...slopeAt(x, z, 0.5 * size_m), hue];
    out.set([x, y, z, size_m, ...look, turn], at);
  }

  private material(kind: PlantKind, reach: { value: number }): MeshLambertMaterial {
    const solid = KIND_LOOKS[kind].surface === "solid";
    const material = new MeshLambertMaterial({ side: solid ? FrontSide : DoubleSide });
    material.onBeforeCompile = (shader) => {
      this.patchVertex(shader, kind, reach, NORMAL_GLSL);
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${definesOf(kind)}${AIR_PARS}${FRAGMENT_PARS}`)
        .replace("#include <map_fragment>", COLOUR_GLSL)
        .replace("#include <normal_fragment_begin>", NORMAL_FRAGMENT_GLSL)
        .replace("#include <lights_fragment_end>", LIGHT_GLSL)
        .replace("#include <opaque_fragment>", AIR_FRAGMENT)
        .replace("#include <fog_fragment>", "");
    };
    material.customProgramCacheKey = () => `galewood-undergrowth-${kind}`;
    return material;
  }

  private shadowMaterial(kind: PlantKind, reach: { value: number }): MeshDepthMaterial {
    const material = new MeshDepthMaterial({ depthPacking: RGBADepthPacking, side: DoubleSide });
    material.onBeforeCompile = (shader) => {
      this.patchVertex(shader, kind, reach, "");
      shader.vertexShader = shader.vertexShader.replace("void main() {", `void main() {\n${SPIN_GLSL}`);
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${definesOf(kind)}${FRAGMENT_PARS}`)
        .replace("#include <map_fragment>", SHADOW_GLSL);
    };
    material.customProgramCacheKey = () => `galewood-undergrowth-shadow-${kind}`;
    return material;
  }

  private patchVertex(
    shader: WebGLProgramParametersWithUniforms,
    kind: PlantKind,
    reach: { value: number },
    normal: string,
  ): void {
    Object.assign(shader.uniforms, air, seasonal, this.shared, this.wind.uniforms, {
      uReach: reach,
      uPlants: { value: this.pictures.plants },
      uNoise: { value: this.pictures.noise },
    });
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${definesOf(kind)}${VERTEX_PARS}`)
      .replace("#include <beginnormal_vertex>", normal)
      .replace("#include <begin_vertex>", POSITION_GLSL);
  }

  /** Keeps clear of these trees, and covers the ground below them with their leaves. */
  shelter(crowns: Crowns): void {
    this.trunks = new Trunks(crowns);
    for (const { field } of this.layers) field.reset();
  }

  setSeason(season: Season): void {
    if (season === this.season) return;
    this.season = season;
    this.dress();
  }

  /** Shows the layers of the season and grows them in its colours. */
  private dress(): void {
    const { season } = this;
    this.shared.uBare.value = season === "winter" ? 1 : 0;
    for (const { kind, field, mesh } of this.layers) {
      mesh.visible = seenIn(kind, season);
      field.reset();
    }
  }

  /** Follows the camera. The plants are made when this is first called. */
  update(eye: Vector3, time_s: number): void {
    if (this.layers.length === 0) this.grow();
    this.shared.uEye.value.copy(eye);
    this.shared.uSeconds.value = time_s % 1000;
    for (const { field, mesh } of this.layers) if (mesh.visible) field.update(eye);
  }

  private clear(): void {
    for (const { mesh } of this.layers) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.customDepthMaterial?.dispose();
    }
    this.layers = [];
  }

  dispose(): void {
    this.clear();
  }
}
