/** The sky table as a half-float texture: air in the lower half, aerosols in the upper half. */
import { ClampToEdgeWrapping, DataTexture, DataUtils, HalfFloatType, LinearFilter, RGBAFormat } from "three";
import { SKY_AZIMUTHS, SKY_ELEVATIONS, type SkyTable } from "./atmosphere";

export function makeSkyTexture(): DataTexture {
  const data = new Uint16Array(SKY_AZIMUTHS * SKY_ELEVATIONS * 2 * 4);
  const texture = new DataTexture(data, SKY_AZIMUTHS, 2 * SKY_ELEVATIONS, RGBAFormat, HalfFloatType);
  texture.minFilter = LinearFilter;
  texture.magFilter = LinearFilter;
  texture.wrapS = ClampToEdgeWrapping;
  texture.wrapT = ClampToEdgeWrapping;
  return texture;
}

/** Writes a sky, multiplied by the light of the sun. */
export function fillSkyTexture(texture: DataTexture, { light }: SkyTable, sun: number): void {
  const data = texture.image.data as Uint16Array;
  for (let texel = 0; texel < light.length / 3; texel++) {
    for (let c = 0; c < 3; c++) data[texel * 4 + c] = DataUtils.toHalfFloat(sun * light[texel * 3 + c]);
    data[texel * 4 + 3] = DataUtils.toHalfFloat(1);
  }
  texture.needsUpdate = true;
}
