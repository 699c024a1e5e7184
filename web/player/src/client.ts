/** Messages to and from the worker `galewood/client-worker`, which has both methods, pulls, streams and shared forests. */

export { EasedPoses } from "./core/motion/easedPoses";
export { type PosePacket, packetBuffers } from "./core/motion/posePacket";
export { Backoff } from "./core/net/backoff";
export type { About } from "./core/wire/wire";
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
  TableMotion,
  ToWorker,
  TreeAt,
  Work,
} from "./worker/protocol";
