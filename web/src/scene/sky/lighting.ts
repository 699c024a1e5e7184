/** The light of the moment: clear sky by season and time of day, clouds by the wind, exposure by what the camera sees. */
import { type PerspectiveCamera, Vector3 } from "three";
import { groundHeight_m } from "../ground/landscape";
import { SEASON_LOOKS, type Season } from "../season/season";
import type { Daylight } from "./daylight";
import { type Atmosphere, atmosphereAt, underClouds } from "./daytime";
import { type Crowns, crownsNear, easeGain, gainFor, type Vector, viewLight } from "./exposure";
import type { Sky } from "./sky";
import { closed, easeWeather, type Weather, weatherFor } from "./weather";

/** Smallest change of a cloud before the sun that is shown. */
const MIN_VISIBLE_CHANGE = 0.01;
/** The exposure is estimated anew every this many pictures. */
const LOOK_EVERY = 5;
/** Crowns are collected anew when the camera has moved this far. */
const MOVED_M = 5;
/** Light that a crown holds back, in leaf and bare. */
const CROWN_DENSITY = { leaf: 0.92, bare: 0.25 } as const;

const aboveGround_m = ({ position: { x, y, z } }: PerspectiveCamera): number => y - groundHeight_m(x, z);

export class Lighting {
  private clear: Atmosphere | null = null;
  private season: Season = "autumn";
  private weather: Weather | null = null;
  private behind = 0;
  private started = false;
  private exposure = 1;
  private gain = 0;
  private target = 1;
  private pictures = 0;
  private all: Crowns = new Float32Array(0);
  private near: Crowns = this.all;
  private readonly nearTo = new Vector3(Number.NaN);
  private readonly axes = [new Vector3(), new Vector3(), new Vector3()] as const;

  constructor(
    private readonly sky: Sky,
    private readonly daylight: Daylight,
  ) {}

  /** The crowns near the camera. */
  crownsNear(eye: Vector3): Crowns {
    if (!(this.nearTo.distanceTo(eye) < MOVED_M)) {
      this.near = crownsNear(this.all, eye);
      this.nearTo.copy(eye);
    }
    return this.near;
  }

  /** All crowns. */
  set crowns(crowns: Crowns) {
    this.all = crowns;
    this.nearTo.x = Number.NaN;
    this.adaptAtOnce();
  }

  /** Lets the exposure of the next picture suit what that shows, as after a cut in a film. */
  adaptAtOnce(): void {
    this.gain = 0;
  }

  /** Chooses season and time of day; takes some milliseconds. */
  choose(daytime: number, season: Season): Atmosphere {
    this.season = season;
    this.clear = atmosphereAt(daytime, season);
    this.weather ??= weatherFor(0, SEASON_LOOKS[season].clouds);
    return this.show(this.clear, this.weather);
  }

  private show(clear: Atmosphere, weather: Weather): Atmosphere {
    const light = underClouds(clear, this.season, weather, this.behind);
    this.daylight.show(light, this.season);
    this.sky.show(light);
    this.exposure = light.exposure;
    return light;
  }

  /** Moves the clouds and changes their cover; nothing changes when dt_s is 0. */
  advance(dt_s: number, wind_m_s: { x: number; z: number }): void {
    this.sky.advance(dt_s, wind_m_s);
    const { clear, weather } = this;
    if (!clear || !weather) return;
    const target = weatherFor(Math.hypot(wind_m_s.x, wind_m_s.z), SEASON_LOOKS[this.season].clouds);
    const next = this.started ? easeWeather(weather, target, dt_s) : target;
    const behind = this.sky.behindCloud(this.daylight.towardsSun, next.cover);
    const changed = next.cover !== weather.cover || next.dark !== weather.dark;
    this.weather = next;
    if (this.started && !changed && Math.abs(behind - this.behind) < MIN_VISIBLE_CHANGE) return;
    this.started = true;
    this.behind = behind;
    this.show(clear, next);
  }

  /** Exposure of the next picture, dt_s after the last one. */
  expose(dt_s: number, camera: PerspectiveCamera): number {
    if (this.gain === 0 || this.pictures++ % LOOK_EVERY === 0) {
      const shadowless = this.weather ? closed(this.weather) : 0;
      const sine = Math.max(this.daylight.towardsSun.y, shadowless);
      this.target = gainFor(this.seen(camera), sine, aboveGround_m(camera));
    }
    this.gain = this.gain === 0 ? this.target : easeGain(this.gain, this.target, dt_s);
    return this.exposure * this.gain;
  }

  private seen(camera: PerspectiveCamera): number {
    const eye = camera.position;
    const [right, up, back] = this.axes;
    camera.matrixWorld.extractBasis(right, up, back);
    const forward: Vector = { x: -back.x, y: -back.y, z: -back.z };
    const halfHeight = Math.tan((camera.fov * Math.PI) / 360);
    return viewLight(
      { eye, forward, right, up, halfHeight, halfWidth: halfHeight * camera.aspect },
      {
        crowns: this.crownsNear(eye),
        sun: this.daylight.towardsSun,
        ground_m: eye.y - aboveGround_m(camera),
        density: this.season === "winter" ? CROWN_DENSITY.bare : CROWN_DENSITY.leaf,
      },
    );
  }
}
