/** Trees that hands hold, where the poses are computed here. Nothing is computed while no tree is pulled. */
import { PULL_EASE_S } from "../../../core/constants";
import { poseStride } from "../../../core/motion/poseStride";
import { DragConstraint } from "../../../core/pull/dragConstraint";
import type { PullOrder, TreeAt } from "../../protocol";
import type { PointResponses, PulledTable } from "./pointResponses";
import { type Pulled, samePoint } from "./pulled";

/** The trees of a source of poses. */
export interface PullableTrees {
  tableOf(group: number): PulledTable | null;
  /** Adds to the oscillators of a tree; returns false if it has none, as with the paper's method. */
  displace(at: TreeAt, e: Float64Array, v: Float64Array): boolean;
}

interface Held {
  order: PullOrder;
  readonly table: string;
  readonly modes: number;
  readonly constraint: DragConstraint;
  /** Remaining time of easing back; only after a release. */
  left_s: number;
}

export class HeldTrees {
  private readonly held = new Map<number, Held>();
  private readonly waiting = new Map<number, PullOrder>();
  private easing: Held[] = [];

  constructor(
    private readonly trees: PullableTrees,
    private readonly responses: PointResponses,
  ) {}

  get pulled(): Pulled[] {
    return [...this.held.values()].map(({ order, table, constraint }) => ({
      order,
      table,
      response: constraint.response,
      force_N: constraint.force_N,
    }));
  }

  /** Hands that hold a tree, or are about to. */
  get hands(): number[] {
    return [...this.held.keys(), ...this.waiting.keys()];
  }

  /** The trees of these hands, and those that ease back. */
  get places(): TreeAt[] {
    const orders = [
      ...[...this.held.values(), ...this.easing].map(({ order }) => order),
      ...this.waiting.values(),
    ];
    return orders.map(({ at }) => at);
  }

  /** Begins or continues a pull. */
  pull(order: PullOrder): void {
    const held = this.held.get(order.hand);
    if (held && samePoint(held.order, order)) held.order = order;
    else {
      this.release(order.hand);
      this.waiting.set(order.hand, order);
    }
  }

  release(hand: number): void {
    this.waiting.delete(hand);
    const held = this.held.get(hand);
    if (!held) return;
    this.held.delete(hand);
    const { e, v } = held.constraint.released;
    if (!this.trees.displace(held.order.at, e, v)) this.easing.push({ ...held, left_s: PULL_EASE_S });
  }

  /** Lets the forces follow the hands, and adds to the poses of the held trees; `out` as written by the step. */
  follow(dt_s: number, out: readonly Float32Array[]): void {
    for (const order of this.waiting.values()) this.begin(order);
    if (this.held.size === 0 && this.easing.length === 0) return;
    const swayed = [...this.held.values()].map((held) => swayedBy(held, out));
    for (const [k, held] of [...this.held.values()].entries()) {
      held.constraint.step(dt_s, held.order.target_m, swayed[k]);
      held.constraint.addPose(out[held.order.at.group], firstOf(held));
    }
    this.ease(dt_s, out);
  }

  private begin(order: PullOrder): void {
    const of = this.trees.tableOf(order.at.group);
    const response = of && this.responses.of(of, order.vertex);
    if (response === "later") return;
    this.waiting.delete(order.hand);
    if (!of || !response) return;
    const { modes } = of.table.metadata;
    this.held.set(order.hand, {
      order,
      table: of.sha256,
      modes,
      constraint: new DragConstraint(response),
      left_s: 0,
    });
  }

  private ease(dt_s: number, out: readonly Float32Array[]): void {
    for (const held of this.easing) {
      held.left_s -= dt_s;
      const t = Math.max(0, held.left_s) / PULL_EASE_S;
      const whole = new Float32Array(held.modes);
      held.constraint.addPose(whole, 0);
      const buffer = out[held.order.at.group];
      for (let k = 0; k < held.modes; k++) buffer[firstOf(held) + k] += t * t * (3 - 2 * t) * whole[k];
    }
    this.easing = this.easing.filter(({ left_s }) => left_s > 0);
  }
}

const firstOf = ({ order, modes }: Held): number => order.at.tree * poseStride(modes);

/** Displacement of the held point without the pull. */
function swayedBy(held: Held, out: readonly Float32Array[]): Float64Array {
  const { point } = held.constraint.response;
  const buffer = out[held.order.at.group];
  const first = firstOf(held);
  return Float64Array.from({ length: 3 }, (_, axis) => {
    let sum = 0;
    for (let k = 0; k < held.modes; k++) sum += point[axis * held.modes + k] * buffer[first + k];
    return sum;
  });
}
