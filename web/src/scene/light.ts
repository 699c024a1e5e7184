/** Afternoon sun with two shadow cascades, and the sky's soft light. */
import { Group, HemisphereLight, Vector3 } from "three";
import { SunLight } from "three/addons/lights/SunLight.js";
import type { Quality } from "../settings";
import { air } from "./air";

const SHADOWS: Record<Quality, { side: number; reach_m: number }> = {
  low: { side: 768, reach_m: 55 },
  medium: { side: 1024, reach_m: 110 },
  high: { side: 2048, reach_m: 170 },
};

export class Daylight {
  readonly group = new Group();
  readonly sun = new SunLight(0xfff0d8, 4.0);
  readonly towardsSun = new Vector3();
  private readonly sky = new HemisphereLight(0xc9dcff, 0x8a6a3a, 1.9);

  constructor(quality: Quality) {
    this.sun.castShadow = true;
    this.group.add(this.sun, this.sky);
    this.point(148, 33);
    this.setQuality(quality);
  }

  /** Azimuth as headings are counted (0 = +x, 90 = +z) and height above the horizon. */
  point(azimuth_deg: number, elevation_deg: number): void {
    const azimuth = (azimuth_deg * Math.PI) / 180;
    const elevation = (elevation_deg * Math.PI) / 180;
    const flat = Math.cos(elevation);
    this.towardsSun.set(flat * Math.cos(azimuth), Math.sin(elevation), flat * Math.sin(azimuth));
    this.sun.position.copy(this.towardsSun);
    air.uSunWorld.value.copy(this.towardsSun);
  }

  get shadowReach_m(): number {
    return this.sun.shadow.camera.far;
  }

  setQuality(quality: Quality): void {
    const { side, reach_m } = SHADOWS[quality];
    const { shadow } = this.sun;
    shadow.mapSize.set(side, side);
    shadow.camera.far = reach_m;
    shadow.normalBias = 0.12;
    shadow.bias = -0.0006;
    shadow.radius = 1.4;
  }

  dispose(): void {
    this.sun.dispose();
    this.sky.dispose();
  }
}
