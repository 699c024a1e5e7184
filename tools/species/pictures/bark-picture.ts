import { blank, type Colour, type Picture } from "./picture";

/** Height (0 groove, 1 ridge) and colour of the bark at a position in the tile. */
interface BarkPoint {
  height: number;
  colour: Colour;
}

export type Bark = (u: number, v: number) => BarkPoint;

export interface BarkPictures {
  colour: Picture;
  normal: Picture;
}

/** Colour and normal map (OpenGL convention, as in glTF) of a tileable bark. */
export function barkPictures(bark: Bark, width: number, height: number, relief: number): BarkPictures {
  const colour = blank(width, height);
  const heights = new Float32Array(width * height);
  for (let i = 0; i < width * height; i++) {
    const point = bark(((i % width) + 0.5) / width, (Math.floor(i / width) + 0.5) / height);
    heights[i] = point.height;
    colour.data.set([...point.colour, 1], i * 4);
  }
  return { colour, normal: normalPicture(heights, width, height, relief) };
}

function normalPicture(heights: Float32Array, width: number, height: number, relief: number): Picture {
  const picture = blank(width, height);
  const at = (x: number, y: number): number =>
    heights[((y + height) % height) * width + ((x + width) % width)];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const dx = (at(x - 1, y) - at(x + 1, y)) * relief;
      const dy = (at(x, y + 1) - at(x, y - 1)) * relief;
      const length = Math.hypot(dx, dy, 1);
      const rgb = [0.5 + (0.5 * dx) / length, 0.5 + (0.5 * dy) / length, 0.5 + 0.5 / length, 1];
      picture.data.set(rgb, (y * width + x) * 4);
    }
  }
  return picture;
}
