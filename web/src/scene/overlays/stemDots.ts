/** A dot above every stem of an inventory, in the colour of its class; other trees do not hide it. */
import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  Group,
  Points,
  PointsMaterial,
  type Texture,
} from "three";
import { groundHeight_m } from "../ground/landscape";
import { FOREST_CENTRE } from "../placement";

/** Size of the mark relative to that of the dots. */
const MARK_SHARE = 2;
const PICTURE_PX = 64;
/** Of the dark rim, which parts the dots from sky and leaves, relative to the radius. */
const RIM_SHARE = 0.2;
const ABOVE_M = 0.8;
const DOT_LOOK = {
  sizeAttenuation: false,
  alphaTest: 0.5,
  depthTest: false,
  depthWrite: false,
  transparent: true,
  toneMapped: false,
  fog: false,
} as const;

interface StemPlace {
  readonly east_m: number;
  readonly north_m: number;
  readonly height_m: number;
}

export class StemDots {
  readonly group = new Group();
  private readonly dots: Points<BufferGeometry, PointsMaterial>;
  /** A larger white dot below that of the selected stem. */
  private readonly mark: Points<BufferGeometry, PointsMaterial>;

  /** `size_px`: diameter of a dot. */
  constructor(size_px: number) {
    const map = discPicture();
    this.mark = points(new PointsMaterial({ ...DOT_LOOK, map, size: MARK_SHARE * size_px }), 8);
    this.dots = points(new PointsMaterial({ ...DOT_LOOK, map, size: size_px, vertexColors: true }), 9);
    this.group.add(this.mark, this.dots);
    this.group.visible = false;
  }

  /** Shows dots; `colours` are those of the stems, in their order; `selected`: one that is marked. */
  show(stems: readonly StemPlace[], colours: readonly string[], selected: number | null): void {
    const places = new Float32Array(3 * stems.length);
    const rgb = new Float32Array(3 * stems.length);
    const colour = new Color();
    stems.forEach(({ east_m, north_m, height_m }, k) => {
      const x = FOREST_CENTRE.x_m + east_m;
      const z = FOREST_CENTRE.z_m - north_m;
      places.set([x, groundHeight_m(x, z) + height_m + ABOVE_M, z], 3 * k);
      colour.set(colours[k]).toArray(rgb, 3 * k);
    });
    place(this.dots, places);
    this.dots.geometry.setAttribute("color", new BufferAttribute(rgb, 3));
    this.mark.visible = selected !== null;
    if (selected !== null) place(this.mark, places.slice(3 * selected, 3 * selected + 3));
    this.group.visible = true;
  }

  hide(): void {
    this.group.visible = false;
  }
}

function points(material: PointsMaterial, order: number): Points<BufferGeometry, PointsMaterial> {
  const made = new Points(new BufferGeometry(), material);
  made.frustumCulled = false;
  made.renderOrder = order;
  return made;
}

function place({ geometry }: Points<BufferGeometry, PointsMaterial>, places_m: Float32Array): void {
  geometry.dispose();
  geometry.setAttribute("position", new BufferAttribute(places_m, 3));
}

function discPicture(): Texture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = PICTURE_PX;
  const drawing = canvas.getContext("2d");
  const middle = PICTURE_PX / 2;
  for (const [colour, radius] of [
    ["#111", middle - 1],
    ["#fff", (1 - RIM_SHARE) * (middle - 1)],
  ] as const) {
    if (!drawing) break;
    drawing.fillStyle = colour;
    drawing.beginPath();
    drawing.arc(middle, middle, radius, 0, 2 * Math.PI);
    drawing.fill();
  }
  return new CanvasTexture(canvas);
}
