/** What main thread and worker say to each other. Types only: neither side imports the other. */
import type { LookupPlace, Method } from "../settings";
import type { WindDocument, WindState } from "../wind";

/** What the screen needs of a table, unpacked by the worker. */
export interface TableMotion {
  readonly sha256: string;
  readonly modes: number;
  /** Floats per tree in a pose buffer: the modes, the local wind speed in m/s, padding to a multiple of four. */
  readonly stride: number;
  readonly nodes: number;
  /** [nodes, 3, stride]: displacement in m per unit of each coordinate, zero beyond the modes. */
  readonly basis: Float32Array<ArrayBuffer>;
  /** Node of each render vertex, primitives concatenated. */
  readonly vertexNode: Uint16Array<ArrayBuffer>;
  readonly primitives: readonly { name: string; kind: string; vertices: number }[];
  /** [3, modes]: mean displacement of the crown (upper 40 % of the height) per unit of each coordinate. */
  readonly crownBasis: Float32Array<ArrayBuffer>;
  readonly height_m: number;
  readonly meshSha256: string;
  readonly poseEasing: number;
  readonly records: number;
  readonly bytes: number;
}

/** The trees of one species: x, z, yaw, scale of each, packed. */
export interface GroupPlan {
  readonly table: string;
  readonly placement: Float32Array<ArrayBuffer>;
}

export interface ForestPlan {
  /** Grows with every new plan; poses that answer an older plan are dropped. */
  readonly epoch: number;
  readonly groups: readonly GroupPlan[];
  readonly lookup: LookupPlace;
  readonly method: Method;
  /** null takes each table's own default. */
  readonly poseEasing: number | null;
}

export type ToWorker =
  | { kind: "load"; sha256: string; url: string }
  | { kind: "plan"; plan: ForestPlan; wind: WindDocument; socketUrl: string }
  | { kind: "wind"; wind: WindDocument }
  /** Moves the forest on; the buffers come back filled. */
  | { kind: "advance"; epoch: number; dt_s: number; buffers: Float32Array<ArrayBuffer>[] };

export type ConnectionState = "idle" | "connecting" | "live" | "lost";

export interface Connection {
  readonly state: ConnectionState;
  readonly latency_ms: number | null;
  /** Time since the newest frame of the server. */
  readonly frameAge_ms: number | null;
  readonly kB_s: number;
}

export type FromWorker =
  | { kind: "table"; motion: TableMotion }
  | { kind: "tableFailed"; sha256: string; title: string }
  | {
      kind: "poses";
      epoch: number;
      time_s: number;
      work_ms: number;
      buffers: Float32Array<ArrayBuffer>[];
      connection: Connection;
      /** The wind and its clock, and the share of trees in winds that their tables have sampled. */
      wind: { state: WindState; coverage: number };
    }
  | { kind: "problem"; title: string; hint: string };
