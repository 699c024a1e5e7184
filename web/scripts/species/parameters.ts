import { apricot } from "./apricot";
import { maple } from "./maple";
import { poplar } from "./poplar";
import type { Species } from "./species";

export const SPECIES: readonly Species[] = [poplar, maple, apricot];
