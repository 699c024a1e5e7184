/** Forests whose poses a Galewood service computes: plans its groups and plays the stream. */

import { drawnMotion } from "../../core/table/drawnMotion";
import type { DrawnMotion } from "../../core/table/drawnTable";
import { decodeWithoutRecords, type Table } from "../../core/table/table";
import type { WindDocument } from "../../core/wind/document";
import { WindField } from "../../core/wind/field";
import { finalWind, parseState } from "../../core/wind/transition";
import type { Reply } from "../../core/wire/wire";
import { PointResponses } from "../motion/pulls/pointResponses";
import { type StreamGroup, StreamMotion } from "../motion/streamMotion";
import type { ShareRequest } from "../protocol";
import type { Floats, GroupFrame } from "./messages";

/** Which stream a forest is. */
export interface StreamRequest {
  readonly kind: "stream";
  /** Address of the service's socket. */
  readonly url: string;
  readonly share: string | null;
  readonly replant: boolean;
}

/** What the page hears of a stream. */
export type StreamNews =
  | { readonly kind: "present"; readonly clients: number }
  | { readonly kind: "sharedWind"; readonly wind: WindDocument }
  | { readonly kind: "problem"; readonly title: string; readonly hint: string };

interface StreamedTable {
  readonly table: Table;
  readonly sha256: string;
}

const SHA256_PATTERN = /[0-9a-f]{64}/;

export class StreamedForest {
  time_s = 0;
  private readonly tables = new Map<number, StreamedTable>();
  private readonly groups = new Map<number, StreamGroup>();
  private field: WindField | null = null;
  private motion: StreamMotion | null = null;
  private share: ShareRequest | null = null;
  private changed = true;

  constructor(
    private readonly request: StreamRequest,
    private readonly notify: (news: StreamNews) => void,
  ) {}

  /** `from`: address of the table at the service, which names its hash. */
  read(table: number, bytes: ArrayBuffer, from: string): DrawnMotion {
    const sha256 = SHA256_PATTERN.exec(from)?.[0];
    if (!sha256)
      throw new Error(`${from}: a stream moves trees of its service only: take them from servedTrees()`);
    const decoded = decodeWithoutRecords(bytes);
    this.tables.set(table, { table: decoded, sha256 });
    return drawnMotion(decoded);
  }

  plant(group: number, table: number, placement: Floats): void {
    const known = this.tables.get(table);
    if (!known) throw new Error(`table ${table} is used before it was loaded`);
    const { height_m, peak_pressure_pa, streamlined_exponent } = known.table.metadata;
    this.groups.set(group, {
      table: known.sha256,
      scale: known.table.modeScale,
      placement,
      height_m,
      sampledPeak_pa: peak_pressure_pa,
      streamlined: streamlined_exponent,
      pulledTable: { ...known, compliance: null },
    });
    this.changed = true;
  }

  remove(group: number): void {
    this.groups.delete(group);
    this.changed = true;
  }

  setWind(wind: WindDocument | null): void {
    if (wind === null) {
      this.notify({
        kind: "problem",
        title: "A streamed forest does not accept a wind function.",
        hint: "Set a wind document: the service computes the motion.",
      });
    } else if (this.field) {
      this.field.change(wind, this.time_s);
      this.motion?.sendWind(wind);
    } else this.field = new WindField(wind);
  }

  private plan(field: WindField, groups: readonly StreamGroup[]): StreamMotion {
    const { url, share, replant } = this.request;
    this.motion?.dispose();
    this.changed = false;
    this.share = share === null ? null : { id: share, replant, about: {} };
    const options = {
      url,
      method: "modal" as const,
      poseEasing: null,
      share: this.share,
      responses: new PointResponses(),
      onReply: (reply: Reply) => this.reply(reply),
      problem: (title: string, hint: string) => this.notify({ kind: "problem", title, hint }),
    };
    return new StreamMotion(groups, field, options, this.time_s);
  }

  private reply(reply: Reply): void {
    if (reply.type === "shared" && this.share) this.share.replant = false;
    else if (reply.type === "presence") this.notify({ kind: "present", clients: reply.clients });
    else if (reply.type === "windState")
      this.notify({ kind: "sharedWind", wind: finalWind(parseState(reply.state)) });
  }

  advance(dt_s: number, _viewer: unknown, frames: readonly GroupFrame[]): void {
    const groups = frames.map(({ group }) => this.groups.get(group));
    if (!this.field || !groups.every((group) => group !== undefined)) return;
    if (this.changed || !this.motion) this.motion = this.plan(this.field, groups);
    this.motion.advance(
      dt_s,
      frames.map(({ poses }) => poses),
    );
    this.time_s = this.motion.time_s;
  }
}
