/** Lighting of the scene: the sun with two shadow cascades, ambient sky light and atmosphere. */
import {
  type Camera,
  DepthFormat,
  DepthTexture,
  Group,
  HemisphereLight,
  LessEqualCompare,
  LinearFilter,
  type OrthographicCamera,
  RedFormat,
  UnsignedShortType,
  Vector3,
  WebGLRenderTarget,
} from "three";
import { SunLight } from "three/addons/lights/SunLight.js";
import type { Quality } from "../quality";
import { SEASON_LOOKS, type Season } from "../season/season";
import { seasonal } from "../season/seasonal";
import { air } from "./air";
import type { Rgb } from "./atmosphere";
import { type Atmosphere, SUN_POWER } from "./daytime";
import { fillSkyTexture, makeSkyTexture } from "./skyTexture";
import { steadyShadows } from "./steadyShadows";
import { closed } from "./weather";

const SHADOWS: Record<Quality, { side: number; reach_m: number }> = {
  low: { side: 768, reach_m: 55 },
  medium: { side: 1024, reach_m: 110 },
  high: { side: 2048, reach_m: 170 },
};
/** Lowest sun for which shadows are drawn as they fall; lower ones would not fit any shadow map. */
const LOWEST_SHADOW = 0.06;
/** Share of the light reflected by the ground that reaches the trees from below. */
const GROUND_REFLECTION = 0.5;
/** Linear light: grass, moss and herbs in spring and summer, fallen leaves in autumn. */
const GROUND_ALBEDO: Record<Season, Rgb> = {
  spring: [0.095, 0.115, 0.05],
  summer: [0.085, 0.11, 0.045],
  autumn: [0.13, 0.105, 0.055],
  winter: [0.7, 0.74, 0.8],
};
/** Gain of the sky light for multiple scattering among leaves and twigs. */
const SKY_GAIN = 1.35;

/** Exposure of the visible sky relative to the land, which keeps its blue from getting too dark. */
const SKY_SHOWN = 1.5;
/** The same for clouds that cover it. */
const OVERCAST_SHOWN = 0.8;

/**
 * A shadow map as three.js makes it, with 3 bytes per texel instead of 8: of the colours, which nothing reads, one channel; of the depth 16 bits,
 * steps of a centimetre or less, which is far below the bias.
 */
function shadowMap(width: number, height: number): WebGLRenderTarget {
  const depthTexture = new DepthTexture(width, height, UnsignedShortType);
  depthTexture.format = DepthFormat;
  depthTexture.compareFunction = LessEqualCompare;
  depthTexture.minFilter = LinearFilter;
  depthTexture.magFilter = LinearFilter;
  return new WebGLRenderTarget(width, height, { format: RedFormat, depthTexture });
}

export class Daylight {
  readonly group = new Group();
  readonly sun = new SunLight(0xffffff, 1);
  readonly towardsSun = new Vector3(0, 1, 0);
  private readonly sky = new HemisphereLight(0xffffff, 0xffffff, 1);
  private readonly texture = makeSkyTexture();

  constructor(quality: Quality) {
    steadyShadows();
    this.sun.castShadow = true;
    this.group.add(this.sun, this.sky);
    air.uSky.value = this.texture;
    this.setQuality(quality);
  }

  /** Shows the light of a moment. */
  show(light: Atmosphere, season: Season): void {
    const { sun, sunlight, skylight, weather } = light;
    this.point(sun.azimuth_deg, sun.elevation_deg);
    const share = closed(weather);
    const irradiance: Rgb = [
      OVERCAST_SHOWN * skylight[0],
      OVERCAST_SHOWN * skylight[1],
      OVERCAST_SHOWN * skylight[2],
    ];
    fillSkyTexture(this.texture, light.table, SKY_SHOWN * SUN_POWER, { share, irradiance });
    this.sun.color.setRGB(...sunlight);
    seasonal.uSunColour.value.setRGB(...sunlight);
    seasonal.uSkyColour.value.setRGB(...skylight);
    this.fillIn(light, season);
    air.uHaze.value.setRGB(...light.haze);
    air.uNightVision.value = light.nightVision;
    air.uMist.value.x = light.mist;
    seasonal.uSnow.value = SEASON_LOOKS[season].snow;
  }

  /** Hemisphere light: sky above, ground below. */
  private fillIn({ sunlight, skylight, sun }: Atmosphere, season: Season): void {
    const level = Math.max(0, Math.sin((sun.elevation_deg * Math.PI) / 180));
    const albedo = GROUND_ALBEDO[season];
    const up = (c: 0 | 1 | 2) => albedo[c] * (GROUND_REFLECTION * sunlight[c] * level + skylight[c]);
    this.sky.color.setRGB(SKY_GAIN * skylight[0], SKY_GAIN * skylight[1], SKY_GAIN * skylight[2]);
    this.sky.groundColor.setRGB(up(0), up(1), up(2));
  }

  private point(azimuth_deg: number, elevation_deg: number): void {
    const azimuth = (azimuth_deg * Math.PI) / 180;
    const elevation = (elevation_deg * Math.PI) / 180;
    const flat = Math.cos(elevation);
    air.uSunWorld.value.set(flat * Math.cos(azimuth), Math.sin(elevation), flat * Math.sin(azimuth));
    air.uSunFlat.value.set(Math.cos(azimuth), Math.sin(azimuth));
    this.towardsSun.copy(air.uSunWorld.value);
    this.towardsSun.y = Math.max(LOWEST_SHADOW, this.towardsSun.y);
    this.towardsSun.normalize();
    this.sun.position.copy(this.towardsSun);
  }

  /** To be called before shadows are drawn. */
  makeShadowMap(): void {
    const { shadow } = this.sun;
    const { x, y } = shadow.getFrameExtents();
    shadow.map ??= shadowMap(x * shadow.mapSize.x, y * shadow.mapSize.y);
  }

  get shadowReach_m(): number {
    return this.sun.shadow.camera.far;
  }

  setQuality(quality: Quality): void {
    const { side, reach_m } = SHADOWS[quality];
    const { shadow } = this.sun;
    if (shadow.mapSize.x !== side) {
      shadow.map?.depthTexture?.dispose();
      shadow.map?.dispose();
      shadow.map = null;
    }
    shadow.mapSize.set(side, side);
    shadow.camera.far = reach_m;
    shadow.normalBias = 0.12;
    shadow.bias = -0.0006;
    shadow.radius = 1.4;
  }

  dispose(): void {
    this.sun.dispose();
    this.sky.dispose();
    this.texture.dispose();
  }
}

/**
 * How far from the eye (m) a caster can stand and still reach the map of a shadow camera: a cascade covers a part of the view
 * around the eye.
 */
export const cascadeReach_m = (shadowCamera: Camera): number =>
  2 * ((shadowCamera as OrthographicCamera).right ?? Number.POSITIVE_INFINITY);
