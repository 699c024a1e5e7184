/** Pulls of a forest that the server moves: its poses contain what the modes show; the forces come with PULLS. */
import type { Pulls } from "../../../core/wire/wire";
import type { PointResponses, PulledTable } from "./pointResponses";
import { type Pulled, treeAtPlace } from "./pulled";

const MOST_KEPT = 32;

export class StreamedPulls {
  private received: Pulls[] = [];

  constructor(
    private readonly tables: readonly PulledTable[],
    private readonly placements: readonly Float32Array[],
    private readonly responses: PointResponses,
  ) {}

  receive(pulls: Pulls): void {
    this.received.push(pulls);
    if (this.received.length > MOST_KEPT) this.received.shift();
  }

  /** The pulls at the displayed time. */
  at(shown_s: number): Pulled[] {
    while (this.received.length > 1 && this.received[1].time_s <= shown_s) this.received.shift();
    const [newest] = this.received;
    if (!newest || newest.time_s > shown_s) return [];
    return newest.pulls.flatMap(({ hand, x, z, vertex, target, force }) => {
      const at = treeAtPlace(this.placements, x, z);
      const of = at && this.tables[at.group];
      const response = of && this.responses.of(of, vertex);
      if (!at || !of || !response || response === "later") return [];
      const order = { hand, at, vertex, target_m: target };
      return [{ order, table: of.sha256, response, force_N: force }];
    });
  }
}
