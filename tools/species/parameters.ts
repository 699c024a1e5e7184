import { apricot, apricotForest } from "./parameters/apricot";
import { maple, mapleForest } from "./parameters/maple";
import { poplar, poplarForest } from "./parameters/poplar";
import type { Species } from "./species";

export const SPECIES: readonly Species[] = [poplar, maple, apricot, poplarForest, mapleForest, apricotForest];
