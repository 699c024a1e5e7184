import { apricot, apricotForest } from "./apricot";
import { maple, mapleForest } from "./maple";
import { poplar, poplarForest } from "./poplar";
import type { Species } from "./species";

export const SPECIES: readonly Species[] = [poplar, maple, apricot, poplarForest, mapleForest, apricotForest];
