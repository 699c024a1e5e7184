/** Meshes of low plants of height 1: shrubs, saplings, ferns and herbs. */

import { hashUnit } from "galewood/random";
import { BufferAttribute, BufferGeometry, Vector3 } from "three";

const TWIG_COUNT = 18;
const FROND_COUNT = 9;
const FROND_PARTS = 3;
/** How far the normals of a frond's edges turn outwards, per unit of its width: its two sides are lit differently. */
const FROND_ROUNDNESS = 2.2;

class Shape {
  private readonly position: number[] = [];
  private readonly normal: number[] = [];
  private readonly uv: number[] = [];
  private readonly index: number[] = [];

  vertex(at: Vector3, normal: Vector3, u: number, v: number): number {
    this.position.push(at.x, at.y, at.z);
    this.normal.push(normal.x, normal.y, normal.z);
    this.uv.push(u, v);
    return this.position.length / 3 - 1;
  }

  quad(a: number, b: number, c: number, d: number): void {
    this.index.push(a, b, c, a, c, d);
  }

  get geometry(): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(this.position), 3));
    geometry.setAttribute("normal", new BufferAttribute(Float32Array.from(this.normal), 3));
    geometry.setAttribute("uv", new BufferAttribute(Float32Array.from(this.uv), 2));
    geometry.setIndex(this.index);
    return geometry;
  }
}

const UP_DIRECTION = new Vector3(0, 1, 0);

/** Cards with the twig of the left picture, leaning outwards all around; rounded normals. */
export function shrub(): BufferGeometry {
  const shape = new Shape();
  for (let twig = 0; twig < TWIG_COUNT; twig++) {
    const at = (channel: number) => hashUnit(151, twig, channel);
    const azimuth = 2.39996 * twig + 0.5 * at(0);
    const out = new Vector3(Math.cos(azimuth), 0, Math.sin(azimuth));
    const lean = 0.15 + 1.05 * Math.sqrt((twig + 0.5) / TWIG_COUNT);
    const along = out.clone().multiplyScalar(Math.sin(lean)).addScaledVector(UP_DIRECTION, Math.cos(lean));
    const length = 0.62 + 0.22 * at(1);
    const foot = out.clone().multiplyScalar(0.06 + 0.1 * at(2));
    foot.y = 0.05 + 0.3 * at(3) * (1 - lean / 1.3);
    const across = new Vector3().crossVectors(
      along,
      out.clone().applyAxisAngle(UP_DIRECTION, 1.2 * (at(4) - 0.5)),
    );
    if (across.lengthSq() < 0.01) across.set(-out.z, 0, out.x);
    across.normalize().multiplyScalar(0.5 * length * 0.95);
    const corner = (side: number, part: number) => {
      const place = foot
        .clone()
        .addScaledVector(along, part * length)
        .addScaledVector(across, side);
      const normal = place
        .clone()
        .setY(place.y - 0.15)
        .normalize()
        .addScaledVector(UP_DIRECTION, 0.35)
        .normalize();
      return shape.vertex(place, normal, 0.25 + 0.25 * side, part);
    };
    shape.quad(corner(-1, 0), corner(1, 0), corner(1, 1), corner(-1, 1));
  }
  return shape.geometry;
}

const SAPLING_TWIGS = 20;
/** Half width of the stem of a sapling at its foot. */
const SAPLING_STEM = 0.011;
/** A place of the left picture that is wood. */
const WOOD_AT = [0.25, 0.06] as const;

/** A young tree: a thin stem with twigs of the left picture, which get shorter towards its top. */
export function sapling(): BufferGeometry {
  const shape = new Shape();
  for (let side = 0; side < 3; side++) {
    const [a, b] = [side, side + 1].map((k) => (2 * Math.PI * k) / 3);
    const corner = (angle: number, y: number, r: number) =>
      shape.vertex(
        new Vector3(r * Math.cos(angle), y, r * Math.sin(angle)),
        new Vector3(Math.cos(angle), 0.2, Math.sin(angle)),
        ...WOOD_AT,
      );
    const top = 0.25 * SAPLING_STEM;
    shape.quad(
      corner(a, 0, SAPLING_STEM),
      corner(b, 0, SAPLING_STEM),
      corner(b, 0.97, top),
      corner(a, 0.97, top),
    );
  }
  for (let twig = 0; twig < SAPLING_TWIGS; twig++) {
    const at = (channel: number) => hashUnit(163, twig, channel);
    const share = (twig + 0.5) / SAPLING_TWIGS;
    const azimuth = 2.39996 * twig + 0.6 * at(0);
    const out = new Vector3(Math.cos(azimuth), 0, Math.sin(azimuth));
    const lean = 1.25 - 0.75 * share + 0.25 * (at(1) - 0.5);
    const along = out.clone().multiplyScalar(Math.sin(lean)).addScaledVector(UP_DIRECTION, Math.cos(lean));
    const length = 0.34 - 0.17 * share + 0.08 * at(2);
    const foot = new Vector3(0, 0.2 + 0.7 * share, 0);
    const across = new Vector3().crossVectors(along, UP_DIRECTION).applyAxisAngle(along, 1.2 * (at(3) - 0.5));
    across.normalize().multiplyScalar(0.5 * length);
    card(shape, foot, along.multiplyScalar(length), across);
  }
  return shape.geometry;
}

const HERB_LEAVES = 6;

/** A rosette of short twigs of the left picture. */
export function herb(): BufferGeometry {
  const shape = new Shape();
  for (let leaf = 0; leaf < HERB_LEAVES; leaf++) {
    const at = (channel: number) => hashUnit(167, leaf, channel);
    const azimuth = (2 * Math.PI * (leaf + 0.6 * at(0))) / HERB_LEAVES;
    const out = new Vector3(Math.cos(azimuth), 0, Math.sin(azimuth));
    const lean = 0.35 + 0.75 * at(1);
    const along = out.clone().multiplyScalar(Math.sin(lean)).addScaledVector(UP_DIRECTION, Math.cos(lean));
    const length = 0.8 + 0.4 * at(2);
    const across = new Vector3(-out.z, 0.3 * (at(3) - 0.5), out.x).multiplyScalar(0.42 * length);
    card(shape, new Vector3(), along.multiplyScalar(length), across);
  }
  return shape.geometry;
}

/** A card of the left picture with normals that are rounded about the plant's middle. */
function card(shape: Shape, foot: Vector3, along: Vector3, across: Vector3): void {
  const corner = (side: number, part: number) => {
    const place = foot.clone().addScaledVector(along, part).addScaledVector(across, side);
    const normal = place
      .clone()
      .setY(0.5 * place.y)
      .normalize()
      .addScaledVector(UP_DIRECTION, 0.6)
      .normalize();
    return shape.vertex(place, normal, 0.25 + 0.25 * side, part);
  };
  shape.quad(corner(-1, 0), corner(1, 0), corner(1, 1), corner(-1, 1));
}

/** Arched strips with the frond of the right picture. */
export function fern(): BufferGeometry {
  const shape = new Shape();
  for (let frond = 0; frond < FROND_COUNT; frond++) {
    const at = (channel: number) => hashUnit(157, frond, channel);
    const azimuth = (2 * Math.PI * (frond + 0.5 * at(0))) / FROND_COUNT;
    const out = new Vector3(Math.cos(azimuth), 0, Math.sin(azimuth));
    const across = new Vector3(-out.z, 0, out.x).multiplyScalar(0.26 + 0.06 * at(1));
    const [reach, top] = [0.7 + 0.35 * at(2), 0.75 + 0.3 * at(3)];
    let before: [number, number] | null = null;
    for (let part = 0; part <= FROND_PARTS; part++) {
      const t = part / FROND_PARTS;
      const place = out.clone().multiplyScalar(0.04 + reach * t ** 1.3);
      place.y = top * (1.75 * t - 0.95 * t * t);
      const normal = UP_DIRECTION.clone().addScaledVector(out, 0.5 * t);
      const side = (to: number) =>
        normal
          .clone()
          .addScaledVector(across, FROND_ROUNDNESS * to)
          .normalize();
      const left = shape.vertex(place.clone().sub(across), side(-1), 0.5, t);
      const right = shape.vertex(place.clone().add(across), side(1), 1, t);
      if (before) shape.quad(before[0], before[1], right, left);
      before = [left, right];
    }
  }
  return shape.geometry;
}
