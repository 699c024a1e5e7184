/** Responses of pulled points, with the compliance files that they need, which are fetched at the first grab. */
import type { Compliance } from "../../../core/pull/compliance";
import { type PointResponse, PullError, pointResponse } from "../../../core/pull/pointResponse";
import type { Table } from "../../../core/table/table";

/** A table and the address of the compliance file of its tree; null: there is none. */
export interface PulledTable {
  readonly sha256: string;
  readonly table: Table;
  readonly compliance: string | null;
}

/** Files by address; null while there is none, because it is being fetched or cannot be read. */
export interface ComplianceFiles {
  /** Begins to fetch a file; resolves also if it cannot be read. */
  load(url: string): Promise<void>;
  get(url: string): Compliance | null;
}

/** Receives the displacements that the modes do not show, for drawing. */
export type PublishField = (table: string, vertex: number, field: Float32Array<ArrayBuffer>) => void;

const NO_FILES: ComplianceFiles = { load: () => Promise.resolve(), get: () => null };

/** Responses are kept for as many points. */
const MAX_KEPT_POINTS = 8;

export class PointResponses {
  private readonly settled = new Map<string, "loading" | "settled">();
  private readonly known = new Map<string, PointResponse | null>();

  constructor(
    private readonly files: ComplianceFiles = NO_FILES,
    private readonly publish: PublishField = () => {},
  ) {}

  /** The response at a vertex; "later" while its file is being fetched, null if there is no such vertex. */
  of({ sha256, table, compliance }: PulledTable, vertex: number): PointResponse | "later" | null {
    if (compliance !== null && this.isLoading(compliance)) return "later";
    const key = `${sha256}:${vertex}`;
    const known = this.known.get(key);
    if (known !== undefined) return known;
    const response = respond(table, vertex, compliance === null ? null : this.files.get(compliance));
    if (response?.rest) this.publish(sha256, vertex, response.rest.field);
    for (const old of this.known.keys()) if (this.known.size >= MAX_KEPT_POINTS) this.known.delete(old);
    this.known.set(key, response);
    return response;
  }

  private isLoading(url: string): boolean {
    const state = this.settled.get(url);
    if (state === undefined) {
      this.settled.set(url, "loading");
      void this.files.load(url).finally(() => this.settled.set(url, "settled"));
    }
    return state !== "settled";
  }
}

function respond(table: Table, vertex: number, file: Compliance | null): PointResponse | null {
  try {
    return pointResponse(table, vertex, file);
  } catch (error) {
    if (error instanceof PullError) return null;
    throw error;
  }
}
