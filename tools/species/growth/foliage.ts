import { Vector3 } from "three";
import { type Random, seededRandom } from "../random";
import { type Profile, sample } from "./growth";
import { type Site, type Stretch, sitesOn } from "./sites";
import type { SurfaceMesh } from "./surface";

/** Arrangement of the leaf cards on the twigs: quads with a picture of a shoot. */
export interface Foliage {
  cards: number;
  size_m: number;
  /** Relative scatter of size. */
  scatter: number;
  /** Angle between card and shoot (degrees) from the base of a twig to its tip. */
  angle_deg: Profile;
  /** Tendency of the cards to point up (positive) or down. */
  lift: number;
  /** Brightness inside the crown (1 = same as outside). */
  shade: number;
  /** Colour variation between boughs and between cards, 0 to 1. */
  bough_tint: number;
  card_tint: number;
}

interface Crown {
  centre: Vector3;
  half: Vector3;
}

const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));
const ATLAS_COLUMNS = 2;

/** Cards distributed over the shoots of the twigs. Each card is a separate piece of four vertices. */
export function leafMesh(shoots: readonly Stretch[], foliage: Foliage, seed: number): SurfaceMesh {
  const random = seededRandom(seed);
  const sites = sitesOn(shoots, foliage.cards, random);
  const crown = crownOf(sites);
  const mesh: SurfaceMesh = { positions: [], normals: [], uvs: [], indices: [], colours: [] };
  const tints = sites.map(() => random.around(0, 1));
  sites.forEach((site, i) => {
    addCard(mesh, site, i, crown, foliage, tints[site.bough % tints.length], random);
  });
  return mesh;
}

function crownOf(sites: readonly Site[]): Crown {
  const low = new Vector3(Infinity, Infinity, Infinity);
  const high = low.clone().negate();
  for (const { position } of sites) {
    low.min(position);
    high.max(position);
  }
  return { centre: low.clone().add(high).multiplyScalar(0.5), half: high.sub(low).multiplyScalar(0.5) };
}

/** Outward direction at a point of the crown, and its relative depth (0 centre, 1 surface). */
function outward(point: Vector3, crown: Crown): { direction: Vector3; depth: number } {
  const relative = point.clone().sub(crown.centre).divide(crown.half);
  const depth = relative.length();
  return { direction: relative.divide(crown.half).normalize(), depth };
}

function addCard(
  mesh: SurfaceMesh,
  site: Site,
  index: number,
  crown: Crown,
  foliage: Foliage,
  boughTint: number,
  random: Random,
): void {
  const size = foliage.size_m * random.around(1, foliage.scatter);
  const axis = cardAxis(site, index, foliage, random);
  const out = outward(site.position.clone().addScaledVector(axis, size / 2), crown);
  const facing = cardNormal(axis, out.direction, random);
  const across = new Vector3().crossVectors(axis, facing);
  const origin = site.position.clone().addScaledVector(axis, -0.06 * size);
  const colour = cardColour(out, foliage, boughTint, random);
  const tile = random.integer(ATLAS_COLUMNS * ATLAS_COLUMNS);
  const mirror = random.uniform(0, 1) < 0.5 ? -1 : 1;
  const first = mesh.positions.length / 3;
  for (const [u, v] of [
    [0, 0],
    [1, 0],
    [1, 1],
    [0, 1],
  ]) {
    const corner = origin
      .clone()
      .addScaledVector(across, (u - 0.5) * size)
      .addScaledVector(axis, v * size);
    const normal = outward(corner, crown).direction.multiplyScalar(0.75).addScaledVector(facing, 0.35);
    normal.y += 0.15;
    normal.normalize();
    mesh.positions.push(corner.x, corner.y, corner.z);
    mesh.normals.push(normal.x, normal.y, normal.z);
    mesh.uvs.push(...atlas(tile, mirror > 0 ? u : 1 - u, v));
    mesh.colours?.push(...colour);
  }
  mesh.indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
}

/** Shoots leave the twig at the species' angle, rotated by the golden angle, and are bent up or down. */
function cardAxis(site: Site, index: number, foliage: Foliage, random: Random): Vector3 {
  const angle = ((sample(foliage.angle_deg, site.along) + random.around(0, 25)) * Math.PI) / 180;
  const helper = Math.abs(site.tangent.y) > 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const side = new Vector3().crossVectors(site.tangent, helper).normalize();
  const radial = side.applyAxisAngle(site.tangent, index * GOLDEN_ANGLE + random.around(0, 0.5));
  const axis = site.tangent.clone().multiplyScalar(Math.cos(angle)).addScaledVector(radial, Math.sin(angle));
  axis.y += foliage.lift * random.uniform(0.3, 1.3);
  return axis.normalize();
}

/** Leaves face the light: outwards and up with a wide scatter, perpendicular to the axis of the card. */
function cardNormal(axis: Vector3, out: Vector3, random: Random): Vector3 {
  const normal = out.clone().multiplyScalar(0.6);
  normal.y += 0.2;
  normal.x += random.around(0, 0.75);
  normal.y += random.around(0, 0.5);
  normal.z += random.around(0, 0.75);
  normal.addScaledVector(axis, -normal.dot(axis));
  if (normal.lengthSq() < 1e-4) normal.set(axis.z, axis.x, axis.y).addScaledVector(axis, -normal.dot(axis));
  return normal.normalize();
}

/** Darker towards the centre and the underside of the crown, with small variations between boughs and cards. */
function cardColour(
  out: { direction: Vector3; depth: number },
  foliage: Foliage,
  boughTint: number,
  random: Random,
): [number, number, number] {
  const light = smoothstep(0.2, 0.95, out.depth) * 0.8 + 0.2 * smoothstep(-0.6, 0.6, out.direction.y);
  const value = foliage.shade + (1 - foliage.shade) * light;
  const hue = boughTint * foliage.bough_tint + random.around(0, 1) * foliage.card_tint;
  const channel = (x: number): number => Math.min(1, Math.max(0, value * x));
  return [
    channel(1 - Math.max(0, -hue) * 0.5),
    channel(0.93 + hue * 0.35),
    channel(0.9 - Math.abs(hue) * 0.3),
  ];
}

function atlas(tile: number, u: number, v: number): [number, number] {
  const column = tile % ATLAS_COLUMNS;
  const row = Math.floor(tile / ATLAS_COLUMNS);
  return [(column + u) / ATLAS_COLUMNS, (row + 1 - v) / ATLAS_COLUMNS];
}

function smoothstep(low: number, high: number, x: number): number {
  const t = Math.min(1, Math.max(0, (x - low) / (high - low)));
  return t * t * (3 - 2 * t);
}
