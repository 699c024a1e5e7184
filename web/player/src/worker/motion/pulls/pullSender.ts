/** Sends the pulls of this visitor to the server, at a limited rate. */
import type { Request } from "../../../core/wire/wire";
import type { PullOrder } from "../../protocol";

/** Below the rate that the server accepts. */
const EVERY_MS = 40;

export class PullSender {
  private sent_ms = Number.NEGATIVE_INFINITY;
  private pending: PullOrder | null = null;

  constructor(
    private readonly placements: readonly Float32Array[],
    private readonly send: (request: Request) => void,
  ) {}

  pull(order: PullOrder, now_ms: number): void {
    this.pending = order;
    this.flush(now_ms);
  }

  release(hand: number): void {
    this.pending = null;
    this.send({ type: "release", hand });
  }

  /** Sends the newest target if it is time; call once per frame. */
  flush(now_ms: number): void {
    const { pending } = this;
    if (!pending || now_ms - this.sent_ms < EVERY_MS) return;
    this.sent_ms = now_ms;
    this.pending = null;
    const { hand, at, vertex, target_m } = pending;
    const [x, z] = this.placements[at.group].subarray(4 * at.tree);
    this.send({ type: "pull", hand, x, z, vertex, target: target_m });
  }
}
