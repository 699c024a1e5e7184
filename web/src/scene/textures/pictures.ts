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
import { type Picture, paintGrass, paintLitter, paintNoise } from "./paint";
import { paintPlants } from "./plantPictures";

function texture({ side, pixels }: Picture, colour: boolean): DataTexture {
  const made = new DataTexture(pixels, side, side);
  made.wrapS = RepeatWrapping;
  made.wrapT = RepeatWrapping;
  made.magFilter = LinearFilter;
  made.minFilter = LinearMipmapLinearFilter;
  made.generateMipmaps = true;
  made.colorSpace = colour ? SRGBColorSpace : NoColorSpace;
  made.needsUpdate = true;
  return made;
}

function plantTexture(): DataTexture {
  const { width, height, pixels } = paintPlants();
  const made = new DataTexture(pixels, width, height);
  made.magFilter = LinearFilter;
  made.minFilter = LinearMipmapLinearFilter;
  made.generateMipmaps = true;
  made.colorSpace = NoColorSpace;
  made.needsUpdate = true;
  return made;
}

export class Pictures {
  readonly noisePicture = paintNoise(256);
  readonly noise = texture(this.noisePicture, false);
  readonly litter = texture(paintLitter(512), true);
  readonly grass = texture(paintGrass(512), true);

  readonly plants = plantTexture();

  /** Anisotropic filtering of the ground, depending on quality: it is expensive with software rendering. */
  setQuality(quality: Quality): void {
    for (const made of [this.litter, this.grass]) {
      const samples = quality === "low" ? 1 : 4;
      if (made.anisotropy === samples) continue;
      made.anisotropy = samples;
      made.needsUpdate = true;
    }
  }

  dispose(): void {
    for (const made of [this.noise, this.litter, this.grass, this.plants]) made.dispose();
  }
}
