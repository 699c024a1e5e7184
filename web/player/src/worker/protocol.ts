/** Messages between main thread and worker. Types only: neither side imports the other. */

import type { Method } from "../core/motion/method";
import type { PosePacket } from "../core/motion/posePacket";
import type { Viewer } from "../core/motion/simulationLevels";
import type { DrawnMotion } from "../core/table/drawnTable";
import type { Foliage } from "../core/table/table";
import type { WindDocument } from "../core/wind/document";
import type { WindState } from "../core/wind/transition";
import type { About } from "../core/wire/wire";

/** First sway mode of a tree of scale 1, by which trees of the background move. */
export interface FirstSway {
  readonly frequency_hz: number;
  /** Relative to critical damping. */
  readonly damping: number;
  /** Static displacement of the tip per Pa of wind pressure. */
  readonly tip_m_pa: number;
  /** Exponent of the pressure over the wind speed (`dynamicPressure`). */
  readonly streamlined: number;
}

/** Where poses are computed. */
export type LookupPlace = "worker" | "server";

/** A forest shared by several clients. */
export interface ShareRequest {
  readonly id: string;
  /** Replace its trees by these for everyone, if they differ; false as soon as the server has done so. */
  replant: boolean;
  /** What others need to reproduce the placement. */
  readonly about: About;
}

/** What the page needs of a table. */
export interface TableMotion extends DrawnMotion {
  readonly sha256: string;
  /** Nearer node of each render vertex. */
  readonly vertexNode: Uint16Array<ArrayBuffer>;
  readonly primitives: readonly { name: string; kind: string; vertices: number }[];
  /** [3, modes]: mean displacement of the crown (upper 40 % of the height) per unit of each coordinate. */
  readonly crownBasis: Float32Array<ArrayBuffer>;
  readonly sway: FirstSway;
  /** Natural frequencies of the first coordinates, which are the oscillators' own shapes. */
  readonly frequencies_hz: Float32Array<ArrayBuffer>;
  readonly meshSha256: string;
  /** Whether the table was made from the tree in leaf or bare. */
  readonly foliage: Foliage;
  /** Whether the table's file holds the records of the paper's state search. */
  readonly hasRecords: boolean;
  /** Whether a better table will replace this one, and what this one leaves out. */
  readonly preliminary: boolean;
  /** Whether the trees move by their natural modes alone. */
  readonly linear: boolean;
  readonly leftOut: readonly string[];
  /** What is drawn at a sway of a fifth of the height (`drawn` of the table's metadata); empty: not measured. */
  readonly drawn: Readonly<Record<string, number>>;
  readonly bytes: number;
}

/** The trees of one species; `placement` holds x, z, yaw, scale of each tree. */
export interface GroupPlan {
  /** Id of the species or upload, independent of its table. */
  readonly key: string;
  readonly table: string;
  /** The table in leaf of the same trees, by which clients of a shared forest in other seasons know them. */
  readonly leafTable: string;
  readonly placement: Float32Array<ArrayBuffer>;
  /** Id of each tree: trees of an earlier plan keep their state. */
  readonly ids: Uint32Array<ArrayBuffer>;
  /** Index of each tree among those of all workers, in ascending order; null: these are all. */
  readonly rows: Uint32Array<ArrayBuffer> | null;
  /** Whether the server has the table's records. */
  readonly recorded: boolean;
  /** Address of the compliance file, which is fetched when a tree is pulled; null: there is none. */
  readonly compliance: string | null;
}

/** One tree of a plan. */
export interface TreeAt {
  readonly group: number;
  readonly tree: number;
}

/** A hand moves a vertex of a tree by `target_m` from rest, in the tree's frame at scale 1. */
export interface PullOrder {
  readonly hand: number;
  readonly at: TreeAt;
  readonly vertex: number;
  readonly target_m: readonly [number, number, number];
}

/** A tree that is drawn with the displacements of a pull which the modes do not show. */
export interface PulledTree {
  readonly hand: number;
  readonly at: TreeAt;
  readonly table: string;
  readonly vertex: number;
  /** In the tree's frame at scale 1. */
  readonly force_N: readonly [number, number, number];
  /** False while it rings down after the release. */
  readonly held: boolean;
}

/** Figures of one tree. */
export interface Inspection {
  /** Sway and pressure relative to the sampled maximum: above 1 the tree is beyond the sampled range. */
  readonly extrapolationRatio: number;
  /** Last record found by the paper's state search; null with the modal method or on the server. */
  readonly record: number | null;
}

/** Time that the worker spent on one frame, ms. */
export interface Work {
  readonly wind_ms: number;
  readonly lookup_ms: number;
  readonly total_ms: number;
}

export interface ForestPlan {
  /** Increases with every plan; poses for an older plan are dropped. */
  readonly epoch: number;
  readonly groups: readonly GroupPlan[];
  readonly lookup: LookupPlace;
  /** Start time of the clock; used by the first plan only. */
  readonly from_s: number;
  /** Trees whose records are not loaded use the modal method. */
  readonly method: Method;
  /** null: the default of each table. */
  readonly poseEasing: number | null;
  /** The shared forest whose wind and clock this one follows. */
  readonly share: ShareRequest | null;
}

/** Displayed trees of one species. */
export interface ShownTrees {
  readonly key: string;
  readonly table: string;
  readonly ids: Uint32Array<ArrayBuffer>;
  /** `poseStride(modes)` floats per tree. */
  readonly poses: Float32Array<ArrayBuffer>;
}

export type ToWorker =
  | { kind: "load"; sha256: string; url: string }
  /** Fetches the records of a loaded table, for the next plan. */
  | { kind: "loadRecords"; table: string; url: string }
  /** Answered as `advance` is. `wind`: of a worker that has been told of none. */
  | {
      kind: "plan";
      plan: ForestPlan;
      wind: WindDocument | WindState;
      socketUrl: string;
      /** What another worker has displayed, which this one continues. */
      shown: readonly ShownTrees[];
    }
  | { kind: "wind"; wind: WindDocument }
  /** Begins or continues a pull, and ends it. */
  | { kind: "pull"; order: PullOrder }
  | { kind: "release"; hand: number }
  /** Sends a gust front from a place, m. */
  | { kind: "gust"; x_m: number; z_m: number }
  /** Stops or resumes the clock of a shared forest, for everyone. */
  | { kind: "pause"; paused: boolean }
  /** Connects to the server at once if the connection is lost. */
  | { kind: "retry" }
  /** Whether nobody looks at the page. */
  | { kind: "hide"; hidden: boolean }
  /** Selects the tree whose figures are sent with the poses. */
  | { kind: "watch"; at: TreeAt | null }
  /** Advances the forest. */
  | {
      kind: "advance";
      epoch: number;
      dt_s: number;
      viewer: Viewer;
      /** A packet that is no longer needed, whose arrays are filled again. */
      spare: PosePacket | null;
    };

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
  /** The records of a table are loaded; `fault`: why they are not. */
  | { kind: "records"; table: string; fault: string | null }
  | {
      kind: "poses";
      epoch: number;
      time_s: number;
      work: Work;
      packet: PosePacket;
      connection: Connection;
      /** The wind state, and the share of trees within the sampled range of winds. */
      wind: { state: WindState; coverage: number };
      /** Maximum over all trees. `watched`: figures of the watched tree. */
      extrapolationRatio: number;
      watched: Inspection | null;
      pulled: readonly PulledTree[];
    }
  /** [vertices, 3, 3] m per N: what the modes do not show of a pull at a vertex, a column per force direction. */
  | { kind: "pullField"; table: string; vertex: number; field: Float32Array<ArrayBuffer> }
  /** Changes that others made to a shared forest. */
  | { kind: "shared"; about: About }
  /** Number of clients of the shared forest, this one included. */
  | { kind: "present"; clients: number }
  | { kind: "sharedWind"; wind: WindDocument }
  /** `code`: of an error of the server. */
  | { kind: "problem"; title: string; hint: string; code: string | null };
