import { Vector3 } from "three";
import { type Random, seededRandom } from "../random";
import { type Profile, sample } from "./growth";
import { type Site, type Stretch, sitesOn, stretches, tips } from "./sites";
import type { SkeletonNode } from "./skeleton";
import type { SurfaceMesh } from "./surface";

/**
 * Arrangement of the twigs: wood too thin to be meshed. One twig is a bent shoot with straight side shoots, all with
 * three sides, in one piece.
 */
export interface Twigs {
  /** Number of twigs along the limbs; every limb bears another one at its tip. */
  count: number;
  /** Length of a shoot from the base of a limb to its tip, m. */
  length_m: Profile;
  /** Relative scatter of the length. */
  scatter: number;
  /** Radius at the base, m; never more than most of the limb's. */
  radius_m: number;
  /** Angle to the limb, degrees, from its base to its tip. */
  angle_deg: Profile;
  /** Relative number of twigs per metre from base to tip, for trunk, boughs and limbs. */
  density: readonly Profile[];
  /** Upward turn of the shoots over their length, 0 to 1; negative ones droop. */
  rise: number;
  /** Nodes of a shoot, and side shoots at each of them: 1 alternate, 2 opposite. */
  nodes: number;
  perNode: 1 | 2;
  side_angle_deg: number;
  /** Length of the lowest side shoot relative to the shoot. */
  side_length: number;
  /** Height below which no twig hangs, m; without it they hang where they grow. */
  lowest_m?: number;
  /** Zigzag of the shoot at its nodes, relative to their distance. */
  zigzag: number;
  /** Linear RGB of the bark. */
  colour: readonly [number, number, number];
}

export interface GrownTwigs {
  mesh: SurfaceMesh;
  /** Axes of all shoots, for the leaves. */
  axes: Stretch[];
}

const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));
const SIDE_COUNT = 3;
/** An inscribed triangle would be too thin: the corners of one of the circle's area. */
const FULL_AREA = Math.sqrt((2 * Math.PI) / (SIDE_COUNT * Math.sin((2 * Math.PI) / SIDE_COUNT)));
/** Radius at the last node relative to the base, and most of the limb's radius that a twig has. */
const LAST_RADIUS = 0.4;
const MOST_OF_LIMB = 0.75;

/** All twigs of a tree. */
export function growTwigs(nodes: readonly SkeletonNode[], twigs: Twigs, seed: number): GrownTwigs {
  const random = seededRandom(seed + 7);
  const grown: GrownTwigs = { mesh: { positions: [], normals: [], uvs: [], indices: [] }, axes: [] };
  sitesOn(stretches(nodes, twigs.density), twigs.count, random).forEach((site, i) => {
    addTwig(grown, site, sideways(site, i, twigs, random), twigs, random);
  });
  for (const site of tips(nodes)) addTwig(grown, site, site.tangent.clone(), twigs, random);
  return grown;
}

/** Twigs leave the limb at the species' angle, rotated by the golden angle; those that would point down turn. */
function sideways(site: Site, index: number, twigs: Twigs, random: Random): Vector3 {
  const angle = ((sample(twigs.angle_deg, site.along) + random.around(0, 12)) * Math.PI) / 180;
  const helper = Math.abs(site.tangent.y) > 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const side = new Vector3().crossVectors(site.tangent, helper).normalize();
  const radial = side.applyAxisAngle(site.tangent, index * GOLDEN_ANGLE + random.around(0, 0.5));
  if (radial.y < -0.35) radial.y *= -0.5;
  radial.addScaledVector(site.tangent, -radial.dot(site.tangent)).normalize();
  return site.tangent.clone().multiplyScalar(Math.cos(angle)).addScaledVector(radial, Math.sin(angle));
}

function addTwig(grown: GrownTwigs, site: Site, start: Vector3, twigs: Twigs, random: Random): void {
  const length = sample(twigs.length_m, site.along) * Math.max(0.4, random.around(1, twigs.scatter));
  const radius = Math.min(twigs.radius_m, MOST_OF_LIMB * site.radius_m);
  const joints = shoot(site.position, start, length, twigs, random);
  const side_m = twigs.side_length * length;
  if (joints.some(({ y }) => y - side_m < (twigs.lowest_m ?? -Infinity))) return;
  const rings = joints.slice(0, -1).map((joint, i) => {
    const thinner = 1 - ((1 - LAST_RADIUS) * i) / (joints.length - 2);
    return addRing(grown.mesh, joint, joints[i + 1].clone().sub(joint).normalize(), radius * thinner);
  });
  closeShoot(grown.mesh, rings, joints[joints.length - 1]);
  const { level, bough } = site;
  const axis = (from: Vector3, to: Vector3, along: number): void => {
    const weight = from.distanceTo(to) * (0.4 + along);
    grown.axes.push({ from, to, weight, radius_m: radius * LAST_RADIUS, along, level, bough });
  };
  for (let i = 0; i + 1 < joints.length; i++) axis(joints[i], joints[i + 1], i / (joints.length - 1));
  for (let i = 1; i < rings.length; i++) {
    for (const tip of sideShoots(joints, i, length, twigs, random)) {
      closeSide(grown.mesh, rings[i], tip, joints[i]);
      axis(joints[i], tip, 0.5 + (0.5 * i) / rings.length);
    }
  }
}

/** Joints of a shoot from its base to its tip: it turns up (or down) and from side to side. */
function shoot(base: Vector3, start: Vector3, length: number, twigs: Twigs, random: Random): Vector3[] {
  const joints = [base.clone()];
  const step = length / (twigs.nodes + 1);
  const flat = new Vector3().crossVectors(start, new Vector3(0, 1, 0));
  if (flat.lengthSq() < 1e-3) flat.set(1, 0, 0);
  flat.normalize();
  for (let i = 0; i <= twigs.nodes; i++) {
    const bent = (twigs.rise * (i + 0.5)) / (twigs.nodes + 1);
    const direction = start.clone().normalize();
    direction.y += bent;
    direction.addScaledVector(flat, (i % 2 ? 1 : -1) * twigs.zigzag + random.around(0, 0.08)).normalize();
    joints.push(joints[i].clone().addScaledVector(direction, step));
  }
  return joints;
}

/** Tips of the side shoots at a joint. */
function sideShoots(joints: Vector3[], i: number, length: number, twigs: Twigs, random: Random): Vector3[] {
  const along = joints[i + 1]
    .clone()
    .sub(joints[i - 1])
    .normalize();
  const helper = Math.abs(along.y) > 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const across = new Vector3().crossVectors(along, helper).normalize();
  const turn = twigs.perNode === 2 ? (i % 2) * 0.9 : i * GOLDEN_ANGLE;
  across.applyAxisAngle(along, turn + random.around(0, 0.4));
  const longest = length * twigs.side_length * (1 - (0.6 * (i - 1)) / twigs.nodes);
  return Array.from({ length: twigs.perNode }, (_, k) => {
    const angle = ((twigs.side_angle_deg + random.around(0, 8)) * Math.PI) / 180;
    const direction = along.clone().multiplyScalar(Math.cos(angle));
    direction.addScaledVector(across, (k ? -1 : 1) * Math.sin(angle));
    direction.y += 0.35 * twigs.rise;
    return joints[i].clone().addScaledVector(direction.normalize(), longest * random.uniform(0.55, 1.1));
  });
}

/** Three vertices around a joint; returns the first. */
function addRing(mesh: SurfaceMesh, centre: Vector3, along: Vector3, radius: number): number {
  const helper = Math.abs(along.y) > 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const side = new Vector3().crossVectors(along, helper).normalize();
  const first = mesh.positions.length / 3;
  for (let k = 0; k < SIDE_COUNT; k++) {
    const normal = side.clone().applyAxisAngle(along, (2 * Math.PI * k) / SIDE_COUNT);
    const point = centre.clone().addScaledVector(normal, radius * FULL_AREA);
    mesh.positions.push(point.x, point.y, point.z);
    mesh.normals.push(normal.x, normal.y, normal.z);
  }
  return first;
}

function addTip(mesh: SurfaceMesh, tip: Vector3, direction: Vector3): number {
  const id = mesh.positions.length / 3;
  mesh.positions.push(tip.x, tip.y, tip.z);
  const up = direction.clone().normalize();
  mesh.normals.push(up.x, up.y, up.z);
  return id;
}

function closeShoot(mesh: SurfaceMesh, rings: number[], tip: Vector3): void {
  for (let i = 0; i + 1 < rings.length; i++) {
    const [low, high] = [rings[i], rings[i + 1]];
    for (let k = 0; k < SIDE_COUNT; k++) {
      const n = (k + 1) % SIDE_COUNT;
      mesh.indices.push(low + k, low + n, high + n, low + k, high + n, high + k);
    }
  }
  mesh.indices.push(rings[0], rings[0] + 2, rings[0] + 1);
  addCone(mesh, rings[rings.length - 1], addTip(mesh, tip, new Vector3(0, 1, 0)));
}

/** A side shoot uses the corners of its ring: a cone, closed inside the shoot. */
function closeSide(mesh: SurfaceMesh, ring: number, tip: Vector3, joint: Vector3): void {
  const id = addTip(mesh, tip, tip.clone().sub(joint));
  addCone(mesh, ring, id);
  mesh.indices.push(ring, ring + 2, ring + 1);
}

function addCone(mesh: SurfaceMesh, ring: number, tip: number): void {
  for (let k = 0; k < SIDE_COUNT; k++) mesh.indices.push(ring + k, ring + ((k + 1) % SIDE_COUNT), tip);
}
