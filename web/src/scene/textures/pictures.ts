/** The procedural pictures as textures, created once and shared by ground and sky. */
import {
  DataTexture,
  LinearFilter,
  LinearMipmapLinearFilter,
  NoColorSpace,
  RepeatWrapping,
  SRGBColorSpace,
} from "three";
import type { Quality } from "../quality";
import { type LandPicture, type LandPictures, paintLand } from "./landPictures";
import { type Picture, paintNoise } from "./paint";

const NOISE_PX = 256;
/**
 * Bias of the ground's level of detail where it is filtered the same in all directions: between the blur of the long side of a pixel's
 * footprint and the noise of the short one.
 */
const SHARPER_BIAS = -0.6;

function smoothed(made: DataTexture, colour: boolean): DataTexture {
  made.magFilter = LinearFilter;
  made.minFilter = LinearMipmapLinearFilter;
  made.generateMipmaps = true;
  made.colorSpace = colour ? SRGBColorSpace : NoColorSpace;
  made.needsUpdate = true;
  return made;
}

function tiled(made: DataTexture): DataTexture {
  made.wrapS = RepeatWrapping;
  made.wrapT = RepeatWrapping;
  return made;
}

/** One pixel, shown until the picture is painted. */
function plain(r: number, g: number, b: number, a: number): DataTexture {
  return new DataTexture(new Uint8Array([r, g, b, a]), 1, 1);
}

/** Replaces the picture of a texture by one of another size. */
function fill(texture: DataTexture, { width, height, pixels }: LandPicture): void {
  texture.dispose(); // storage on the GPU has a fixed size
  texture.image = { data: pixels, width, height };
  texture.needsUpdate = true;
}

export class Pictures {
  /** Empty until it is painted. */
  readonly noisePicture: Picture = { side: NOISE_PX, pixels: new Uint8Array(4 * NOISE_PX ** 2) };
  readonly noise = smoothed(tiled(new DataTexture(this.noisePicture.pixels, NOISE_PX, NOISE_PX)), false);
  /** Mean colours of the pictures until those arrive; plants are transparent. */
  readonly litter = smoothed(tiled(plain(107, 70, 32, 255)), true);
  readonly grass = smoothed(tiled(plain(110, 107, 45, 255)), true);
  readonly plants = smoothed(plain(0, 0, 0, 0), false);
  /** Bias of the level of detail of the ground's pictures. */
  readonly groundBias = { value: 0 };
  private painter: Worker | null = null;
  private painted = false;

  paintNoise(): void {
    this.noisePicture.pixels.set(paintNoise(NOISE_PX).pixels);
    this.noise.needsUpdate = true;
  }

  /** Paints the other pictures, once. Painting takes as long as the rest of the start, so it begins when trees are seen. */
  paint(): void {
    if (this.painted) return;
    this.painted = true;
    if (typeof Worker === "undefined") {
      this.receive(paintLand());
      return;
    }
    this.painter = new Worker(new URL("./painting.worker.ts", import.meta.url), { type: "module" });
    this.painter.onmessage = ({ data }: MessageEvent<LandPictures>) => {
      this.receive(data);
      this.painter?.terminate();
    };
  }

  private receive({ litter, grass, plants }: LandPictures): void {
    fill(this.litter, litter);
    fill(this.grass, grass);
    fill(this.plants, plants);
  }

  /** Anisotropic filtering of the ground, depending on quality: it is expensive with software rendering. */
  setQuality(quality: Quality): void {
    const samples = quality === "low" ? 1 : 4;
    this.groundBias.value = samples === 1 ? SHARPER_BIAS : 0;
    for (const made of [this.litter, this.grass]) {
      if (made.anisotropy === samples) continue;
      made.anisotropy = samples;
      made.needsUpdate = true;
    }
  }

  dispose(): void {
    this.painter?.terminate();
    for (const made of [this.noise, this.litter, this.grass, this.plants]) made.dispose();
  }
}
