/**
 * Building blocks of the renderer, for a scene that needs more than `Forest` of galewood/three: it brings its own materials,
 * impostors and worker. They change more often than the simple entry points.
 */
export { LEVEL_SHARES } from "./core/constants";
export { groundUnder, type Ray } from "./core/math/groundRay";
export { bendNodes } from "./core/table/cardLevel";
export {
  CLOSE_FLOATS,
  type CloseLeaves,
  fillClose,
  type HeldSprays,
  type SprayRoom,
} from "./trees/culling/closeLeaves";
export { type Bounds, cylinderSeen, shadowSeen } from "./trees/culling/culling";
export { nearRank, rankedIndex } from "./trees/detail";
export type { DrawList, View } from "./trees/drawList";
export type { ShadowOptions } from "./trees/drawnParts";
export { type FarCards, fillCards } from "./trees/farCards";
export {
  createInstanceData,
  INSTANCE_FLOATS,
  type InstanceData,
  isSpacious,
  type Placement,
  roomFor,
  setTints,
  type Tint,
} from "./trees/instanceData";
export { leafFrequency_hz } from "./trees/leafFlutter";
export { LEAN_SHADER } from "./trees/lean";
export type { Components } from "./trees/mesh/components";
export { limbsOf, type PartGeometry, STEM_LIMB } from "./trees/mesh/limbs";
export { openMesh } from "./trees/mesh/openMesh";
export {
  type MeshArrays,
  type Part,
  type PartArrays,
  type ReadMeshes,
  type ReadPart,
  readMeshes,
} from "./trees/mesh/partArrays";
export { type SingleLeaves, SPRAY_FLOATS, type SprayShape } from "./trees/mesh/singleLeaves";
export {
  type AddedPart,
  disposeModel,
  drawnPart,
  type OpenedMeshes,
  openedMeshes,
  readPlainTree,
  type TreeModel,
  type TreePart,
} from "./trees/mesh/treeMesh";
export { GLSL_GRAPHICS } from "./trees/nodes/glslNodes";
export { NODE_TEXEL } from "./trees/nodes/nodeTexel";
export type { LevelTexels } from "./trees/nodes/treeNodes";
export type { MaterialMaker, PartMaterials } from "./trees/partMaterials";
export { PULL_PARS } from "./trees/pull/pullShader";
export { PullSlots, type ShownPull } from "./trees/pull/pullSlots";
export { SpeciesForest, type SpeciesOptions } from "./trees/speciesForest";
export { UNMAPPED_BELOW } from "./trees/together/mergedParts";
export { drawsTogether, together } from "./trees/together/togetherMeshes";
export { TOGETHER_PARS } from "./trees/together/togetherShader";
export { leanAt, ownRay, type PickedTree, pickTree, type UprightTrees } from "./trees/treePick";
export {
  deform,
  type SpeciesUniforms,
  type Standing,
  type TreeUniforms,
  type Variant,
} from "./trees/treeShader";
export { COMMON_KEY, MISSING_BRANCH_SHARE, VARIANT_SHADER } from "./trees/variantShader";
