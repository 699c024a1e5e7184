/** What poses of trees mean: nodes, tips, displacements of crowns, and the methods by which they are computed. */
export { meanCrownDisplacement_m } from "./core/motion/crownDisplacement";
export { METHODS, type Method, parseMethod } from "./core/motion/method";
export { type Jointed, NodePose, poseNow } from "./core/motion/nodePose";
export { nearestTree, tipDisplacement_m, tipNode } from "./core/motion/tip";
