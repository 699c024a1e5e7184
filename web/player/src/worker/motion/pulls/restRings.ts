/** Forces for the part of a pull that the modes do not show: while a tree is held, and as it rings down. */
import { restFrequency, ringShare } from "../../../core/pull/restRing";
import type { PulledTree } from "../../protocol";
import type { Pulled } from "./pulled";

interface Ring {
  readonly from: Pulled;
  readonly force_N: Float64Array;
  readonly omega: number;
  age_s: number;
}

export class RestRings {
  private before = new Map<number, Pulled>();
  private rings: Ring[] = [];

  /** The trees to draw with additional displacements, dt_s after the last call. */
  advance(pulled: readonly Pulled[], dt_s: number): PulledTree[] {
    const now = new Map(pulled.map((one) => [one.order.hand, one] as const));
    for (const [hand, old] of this.before) if (!sameAs(old, now.get(hand))) this.ring(old);
    this.before = new Map(pulled.map((one) => [one.order.hand, kept(one)] as const));
    for (const ring of this.rings) ring.age_s += dt_s;
    this.rings = this.rings.filter(({ omega, age_s }) => ringShare(omega, age_s) !== null);
    return [...pulled.map((one) => shown(one, 1, true)), ...this.rings.map(shownRing)];
  }

  /** Forgets everything: the trees have changed. */
  clear(): void {
    this.before.clear();
    this.rings = [];
  }

  private ring(from: Pulled): void {
    const { rest } = from.response;
    if (!rest) return;
    const force_N = Float64Array.from(from.force_N);
    this.rings.push({ from, force_N, omega: restFrequency(rest, force_N), age_s: 0 });
  }
}

const sameAs = (old: Pulled, now: Pulled | undefined): boolean =>
  now !== undefined && now.table === old.table && now.response === old.response;

const kept = (one: Pulled): Pulled => ({ ...one, force_N: Float64Array.from(one.force_N) });

function shown({ order, table, force_N }: Pulled, share: number, held: boolean): PulledTree {
  const { hand, at, vertex } = order;
  const [x, y, z] = [0, 1, 2].map((axis) => share * force_N[axis]);
  return { hand, at, table, vertex, force_N: [x, y, z], held };
}

const shownRing = ({ from, force_N, omega, age_s }: Ring): PulledTree =>
  shown({ ...from, force_N }, ringShare(omega, age_s) ?? 0, false);
