/** The pictures of the ground and its plants. Pure. */
import { paintGrass, paintLitter } from "./paint";
import { paintPlants } from "./plantPictures";

/** RGBA, one byte per channel. */
export interface LandPicture {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint8Array<ArrayBuffer>;
}

export interface LandPictures {
  readonly litter: LandPicture;
  readonly grass: LandPicture;
  readonly plants: LandPicture;
}

const GROUND_PX = 512;

export function paintLand(): LandPictures {
  const ground = { width: GROUND_PX, height: GROUND_PX };
  return {
    litter: { ...ground, pixels: paintLitter(GROUND_PX).pixels },
    grass: { ...ground, pixels: paintGrass(GROUND_PX).pixels },
    plants: paintPlants(),
  };
}
