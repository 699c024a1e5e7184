/** Messages to and from the worker `galewood/client-worker`, which has both methods, pulls, streams and shared forests. */
export { Backoff } from "./core/net/backoff";
export type { FirstSway } from "./core/table/drawnTable";
export type { About } from "./core/wire/wire";
export type {
  Connection,
  ForestPlan,
  FromWorker,
  GroupPlan,
  Inspection,
  LookupPlace,
  PulledTree,
  PullOrder,
  TableMotion,
  ToWorker,
  TreeAt,
  Work,
} from "./worker/protocol";
