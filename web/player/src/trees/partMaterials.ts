/** What a species needs to know of the materials of its parts, whoever makes them. */
import type { Material, MeshStandardMaterial } from "three";
import type { Part } from "./mesh/partArrays";
import type { SpeciesUniforms } from "./treeShader";

/** Materials of a part, all with the deformation of pass 2. */
export interface PartMaterials {
  readonly colour: Material;
  /** For the shadow maps of directional lights and spotlights; without it the renderer makes its own of `colour`. */
  readonly shadow?: Material;
  /** For those of point lights. */
  readonly distance?: Material;
}

/** Makes the materials of a part from that of its mesh; without motion if it does not move. */
export type MaterialMaker = (
  from: MeshStandardMaterial,
  part: Part,
  uniforms: SpeciesUniforms,
  moves: boolean,
) => PartMaterials;
