import { Euler, Quaternion, Vector3 } from "three";
import { type Random, seededRandom } from "../random";
import { Tree } from "./ez-tree";
import type { SkeletonNode } from "./skeleton";

/** A curve through equally spaced values over [0, 1]. */
export type Profile = readonly number[];

/** Arrangement of the side branches of one order on their parent. */
interface Branching {
  /** Number of side branches on each successive piece (body, then leaders) of a full-length parent. */
  count: readonly number[];
  /** Position of the first one on the parent's first piece, 0 to 1. */
  start: number;
  /** Angle to the parent (degrees) by position along it. */
  angle_deg: Profile;
  /** Length by position along the parent, in the generator's units. */
  length: Profile;
  /** Preferred maximum of the initial rise (sine of the inclination) of a side branch. */
  steepest: number;
  /** Relative scatter of length and angle. */
  scatter: number;
}

/** Shape parameters of a species, in addition to the generator's options. */
export interface Habit {
  seed: number;
  /** Generator options, in the format of its presets. */
  options: object;
  /** Side branches of the trunk and of the boughs. */
  branching: readonly Branching[];
  /** Length of each leader relative to the piece that it continues, for trunk, boughs and twigs. */
  leader: readonly (readonly number[])[];
}

interface Section {
  origin: Vector3;
  orientation: Euler;
  radius: number;
}

type QueuedBranch = InstanceType<typeof Tree>["branchQueue"][number];

/** Data of a branch in addition to those of the generator. */
interface Lineage {
  parentNode: number;
  branch: number;
  order: number;
  /** 0 for the body of the branch, 1 and 2 for the leaders that continue it. */
  piece: number;
  /** Start of this piece along the whole branch, and the share that it covers. */
  from: number;
  span: number;
  /** Length relative to the longest of its order. */
  size: number;
}

const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));

/** The generator with its own branch placement replaced, and without geometry. */
class GrowingTree extends Tree {
  readonly nodes: SkeletonNode[] = [];
  private readonly habit: Habit;
  private readonly random: Random;
  private readonly lineage = new WeakMap<QueuedBranch, Lineage>();
  private branchCount = 1;
  private current!: QueuedBranch;

  constructor(habit: Habit) {
    super();
    this.habit = habit;
    this.random = seededRandom(habit.seed);
    this.options.copy(habit.options as never, this.options as never);
    (this.options as { seed: number }).seed = habit.seed;
  }

  override generateBranch(branch: QueuedBranch): void {
    this.current = branch;
    super.generateBranch(branch);
  }

  override generateChildBranches(_count: number, _level: number, sections: Section[]): void {
    const lineage = this.lineageOf(this.current);
    const nodeIds = this.record(sections, lineage);
    this.adoptLeader(lineage, nodeIds[nodeIds.length - 1]);
    const branching = this.habit.branching[lineage.order];
    if (branching) this.placeChildren(sections, nodeIds, lineage, branching);
  }

  override generateLeaves(sections: Section[]): void {
    this.record(sections, this.lineageOf(this.current));
  }

  override generateLeaf(): void {}
  override createBranchesGeometry(): void {}
  override createLeavesGeometry(): void {}

  private lineageOf(branch: QueuedBranch): Lineage {
    const trunk = {
      parentNode: -1,
      branch: 0,
      order: 0,
      piece: 0,
      from: 0,
      span: 1 / this.pieces(0),
      size: 1,
    };
    return this.lineage.get(branch) ?? trunk;
  }

  /** Length of a whole branch relative to its body. */
  private pieces(order: number): number {
    let [total, piece] = [1, 1];
    for (const ratio of this.habit.leader[order]) {
      piece *= ratio;
      total += piece;
    }
    return total;
  }

  /** Stores the sections as nodes; a leader shares its first section with the piece below. */
  private record(sections: Section[], lineage: Lineage): number[] {
    const ids = lineage.piece > 0 ? [lineage.parentNode] : [];
    for (const section of lineage.piece > 0 ? sections.slice(1) : sections) {
      const parent = ids.length > 0 ? ids[ids.length - 1] : lineage.parentNode;
      ids.push(this.nodes.length);
      const { branch, order } = lineage;
      this.nodes.push({ position: section.origin.clone(), parent, branch, level: order, radius: 0 });
    }
    return ids;
  }

  /** Makes the leader that the generator has just queued a part of the current branch. */
  private adoptLeader(lineage: Lineage, lastNode: number): void {
    const leader = this.branchQueue[this.branchQueue.length - 1];
    const ratio = this.habit.leader[lineage.order][lineage.piece];
    leader.length = this.current.length * ratio;
    leader.sectionCount = Math.max(2, Math.round(this.current.sectionCount * ratio));
    const from = lineage.from + lineage.span;
    const next = { parentNode: lastNode, piece: lineage.piece + 1, from, span: lineage.span * ratio };
    this.lineage.set(leader, { ...lineage, ...next });
  }

  private placeChildren(sections: Section[], nodeIds: number[], lineage: Lineage, plan: Branching): void {
    const count = Math.round((plan.count[lineage.piece] ?? 0) * lineage.size);
    const start = lineage.piece === 0 ? plan.start : 0;
    const turn = this.random.uniform(0, 2 * Math.PI);
    for (let i = 0; i < count; i++) {
      const along = start + (1 - start) * ((i + this.random.uniform(0.2, 0.8)) / count);
      const radial = turn + i * GOLDEN_ANGLE + this.random.around(0, 0.35);
      this.placeChild(sections, nodeIds, lineage, plan, along, radial);
    }
  }

  private placeChild(
    sections: Section[],
    nodeIds: number[],
    lineage: Lineage,
    plan: Branching,
    along: number,
    radial: number,
  ): void {
    const below = Math.min(Math.floor(along * (sections.length - 1)), sections.length - 2);
    const fork = between(sections[below], sections[below + 1], along * (sections.length - 1) - below);
    const position = lineage.from + lineage.span * along;
    const vary = (): number => this.random.around(1, plan.scatter);
    const angle_rad = (sample(plan.angle_deg, position) * vary() * Math.PI) / 180;
    const orientation = sideways(fork.orientation, angle_rad, radial, plan.steepest);
    const size = (sample(plan.length, position) / Math.max(...plan.length)) * vary();
    const child = { parentNode: nodeIds[below], order: lineage.order + 1, size };
    this.enqueue(fork, orientation, size * Math.max(...plan.length), child);
  }

  private enqueue(
    fork: Section,
    orientation: Euler,
    length: number,
    lineage: Pick<Lineage, "parentNode" | "order" | "size">,
  ): void {
    const { levels, sections, segments, radius } = this.options.branch as unknown as GeneratorBranchOptions;
    const level = Math.min(lineage.order, levels);
    const span = 1 / this.pieces(lineage.order);
    const child = {
      origin: fork.origin.clone(),
      orientation,
      length: length * span,
      radius: fork.radius * radius[level],
      level,
      sectionCount: sections[level],
      segmentCount: segments[level],
    };
    this.lineage.set(child, { ...lineage, branch: this.branchCount++, piece: 0, from: 0, span });
    this.branchQueue.push(child);
  }
}

interface GeneratorBranchOptions {
  levels: number;
  sections: Record<number, number>;
  segments: Record<number, number>;
  radius: Record<number, number>;
}

function between(a: Section, b: Section, t: number): Section {
  const qa = new Quaternion().setFromEuler(a.orientation);
  const qb = new Quaternion().setFromEuler(b.orientation);
  return {
    origin: a.origin.clone().lerp(b.origin, t),
    orientation: new Euler().setFromQuaternion(qa.slerp(qb, t)),
    radius: a.radius + (b.radius - a.radius) * t,
  };
}

/**
 * Direction of a side branch at its angle to the parent: the first one on the circle from `radial_rad` on that neither
 * hangs nor points straight up, so that side branches spread in flat layers.
 */
function sideways(parent: Euler, angle_rad: number, radial_rad: number, steepest: number): Euler {
  const lean = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), angle_rad);
  const base = new Quaternion().setFromEuler(parent);
  const turned = (k: number): Quaternion => {
    const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), radial_rad + k * GOLDEN_ANGLE);
    return base.clone().multiply(turn.multiply(lean));
  };
  const candidates = Array.from({ length: 12 }, (_, k) => turned(k));
  const rise = (q: Quaternion): number => new Vector3(0, 1, 0).applyQuaternion(q).y;
  const level = candidates.find((q) => rise(q) > -0.12 && rise(q) < steepest);
  return new Euler().setFromQuaternion(level ?? candidates[0]);
}

/** Value of a profile at t in [0, 1], linear between its points. */
export function sample(profile: Profile, t: number): number {
  const x = Math.min(Math.max(t, 0), 1) * (profile.length - 1);
  const i = Math.min(Math.floor(x), profile.length - 2);
  return profile[i] + (profile[i + 1] - profile[i]) * (x - i);
}

/** Grows the skeleton of a species in the generator's units; radii are not set yet. */
export function growSkeleton(habit: Habit): SkeletonNode[] {
  const tree = new GrowingTree(habit);
  tree.generate();
  return tree.nodes;
}
