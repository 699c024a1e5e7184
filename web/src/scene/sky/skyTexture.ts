/** The sky table as a half-float texture: air in the lower half, aerosols in the upper half. */
import { ClampToEdgeWrapping, DataTexture, DataUtils, HalfFloatType, LinearFilter, RGBAFormat } from "three";
import { elevationOf_rad, type Rgb, SKY_AZIMUTHS, SKY_ELEVATIONS, type SkyTable } from "./atmosphere";
import { overcastRadiance } from "./weather";

export function makeSkyTexture(): DataTexture {
  const data = new Uint16Array(SKY_AZIMUTHS * SKY_ELEVATIONS * 2 * 4);
  const texture = new DataTexture(data, SKY_AZIMUTHS, 2 * SKY_ELEVATIONS, RGBAFormat, HalfFloatType);
  texture.minFilter = LinearFilter;
  texture.magFilter = LinearFilter;
  texture.wrapS = ClampToEdgeWrapping;
  texture.wrapT = ClampToEdgeWrapping;
  return texture;
}

/** Grey light that replaces the clear sky where clouds close: share, and irradiance on level ground. */
export interface Overcast {
  readonly share: number;
  readonly irradiance: Rgb;
}

/** Writes a sky, multiplied by the light of the sun. */
export function fillSkyTexture(
  texture: DataTexture,
  { light }: SkyTable,
  sun: number,
  overcast: Overcast,
): void {
  const data = texture.image.data as Uint16Array;
  const { share, irradiance } = overcast;
  const texels = light.length / 3;
  for (let texel = 0; texel < texels; texel++) {
    const air = 2 * texel < texels;
    const row = Math.floor(texel / SKY_AZIMUTHS) % SKY_ELEVATIONS;
    const grey = air ? overcastRadiance(Math.sin(elevationOf_rad(row))) : 0;
    for (let c = 0; c < 3; c++) {
      const value = (1 - share) * sun * light[texel * 3 + c] + share * grey * irradiance[c];
      data[texel * 4 + c] = DataUtils.toHalfFloat(value);
    }
    data[texel * 4 + 3] = DataUtils.toHalfFloat(1);
  }
  texture.needsUpdate = true;
}
