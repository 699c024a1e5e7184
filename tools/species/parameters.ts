import { apricot, apricotForest } from "./parameters/apricot";
import { ash, ashForest } from "./parameters/ash";
import { beech, beechForest } from "./parameters/beech";
import { birch, birchForest } from "./parameters/birch";
import { larch, larchForest } from "./parameters/larch";
import { maple, mapleForest } from "./parameters/maple";
import { oak, oakForest } from "./parameters/oak";
import { pine, pineForest } from "./parameters/pine";
import { poplar, poplarForest } from "./parameters/poplar";
import { spruce, spruceForest } from "./parameters/spruce";
import { sycamore, sycamoreForest } from "./parameters/sycamore";
import { willow, willowForest } from "./parameters/willow";
import type { Species } from "./species";

const OPEN_GROWN = [
  ...[poplar, maple, apricot, birch, oak, beech],
  ...[ash, sycamore, willow, spruce, pine, larch],
];
const FOREST_GROWN = [
  ...[poplarForest, mapleForest, apricotForest, birchForest, oakForest, beechForest],
  ...[ashForest, sycamoreForest, willowForest, spruceForest, pineForest, larchForest],
];

export const SPECIES: readonly Species[] = [...OPEN_GROWN, ...FOREST_GROWN];
