/** The page's side of the worker `galewood/client-worker`, which has both methods, pulls, streams and shared forests, and of several. */

export { EasedPoses } from "./core/motion/easedPoses";
export type { PosePacket } from "./core/motion/posePacket";
export type { Viewer } from "./core/motion/simulationLevels";
export { Backoff } from "./core/net/backoff";
export type { About } from "./core/wire/wire";
export { ForestWorkers, type FromWorkers, type PlanOrder } from "./worker/divided/forestWorkers";
export type {
  Connection,
  FirstSway,
  ForestPlan,
  FromWorker,
  GroupPlan,
  Inspection,
  LookupPlace,
  PulledTree,
  PullOrder,
  ShownTrees,
  TableMotion,
  ToWorker,
  TreeAt,
  Work,
} from "./worker/protocol";
