/** The page's models of trees: normalised GLBs with what it draws in addition: trees that lack limbs, bare trees, flares, collars. */

import {
  type AddedPart,
  drawnPart,
  leafFrequency_hz,
  type SingleLeaves,
  type TreeModel,
  type TreePart,
} from "galewood/trees";
import type { MeshStandardMaterial, Texture } from "three";
import { barePartsOf, singlesOf, sprayStemsOf, spraysOf, twigsOf } from "./cardParts";
import { OF_LEAVES, OF_NEEDLES } from "./leafSprays";
import { openTree, type TreePictures } from "./openTree";
import { sprayShapes } from "./singleLeaves";
import type { ReadTree, TreeKind } from "./treeArrays";
import { treeReader } from "./treeReader";
import type { AddedArrays } from "./wood/addedWood";

/** The material of the leaves with another picture; null for a tree without leaves. */
function spraysMaterial(
  parts: readonly TreePart[],
  picture: Texture,
  evergreen: boolean,
): MeshStandardMaterial | null {
  const material = parts.find(({ kind }) => kind === "leaves")?.material.clone() ?? null;
  if (material) {
    material.map = picture;
    material.userData = { evergreen };
  }
  return material;
}

/** `materialOf`: that of what is added to a part. */
const drawn = (
  added: readonly AddedArrays[],
  materialOf: (of: number) => MeshStandardMaterial,
): AddedPart[] => added.map(({ part, of }) => ({ part: drawnPart(part, materialOf(of)), of }));

function modelOf(
  materials: readonly MeshStandardMaterial[],
  { sprays, drawnSprays }: TreePictures,
  { read, added, height_m, radius_m }: ReadTree,
  { varied, evergreen }: TreeKind,
): TreeModel {
  const parts = read.map(({ part }, k) => drawnPart(part, materials[k]));
  for (const { kind, material } of parts) {
    Object.assign(material.userData, { shoots: varied && kind === "leaves", evergreen });
  }
  const ofSprays = sprays && spraysMaterial(parts, sprays, evergreen);
  const habit = drawnSprays ? OF_LEAVES : OF_NEEDLES;
  const ofTwigs = () => materials[twigsOf(read)];
  let bareParts: AddedPart[] | null = null;
  let nearParts: AddedPart[] | null = null;
  let singles: SingleLeaves | null | undefined;
  return {
    parts,
    materials: [...materials, ...(ofSprays ? [ofSprays] : [])],
    get bare() {
      bareParts ??= drawn(barePartsOf(read), ofTwigs);
      return bareParts;
    },
    added: drawn(added, (of) => materials[of]),
    get near() {
      nearParts ??= ofSprays
        ? [...drawn(sprayStemsOf(read), ofTwigs), ...drawn(spraysOf(read, habit), () => ofSprays)]
        : [];
      return nearParts;
    },
    get singles() {
      if (singles === undefined) {
        const placed = ofSprays && drawnSprays && singlesOf(read);
        singles = placed && { ...placed, material: ofSprays, shapes: sprayShapes(drawnSprays) };
      }
      return singles;
    },
    leans: varied,
    evergreen,
    ...(drawnSprays && { flutter_hz: leafFrequency_hz(drawnSprays.petiole_m) }),
    height_m,
    radius_m,
  };
}

/** Whether the picture of a material cuts shapes out of its triangles. */
const cutsOut = ({ alphaTest, transparent }: MeshStandardMaterial) => alphaTest > 0 || transparent;

/**
 * The model of a tree by its GLB; rejects if it contains no mesh. `base`: as for `openMesh`. `reads`: called when it is being read, which
 * keeps the page free.
 */
export async function readTreeModel(
  bytes: ArrayBuffer,
  base: string,
  kind: TreeKind,
  reads?: () => void,
): Promise<TreeModel> {
  const { meshes, pictures } = openTree(bytes, base);
  pictures.catch(() => undefined); // a mesh that cannot be opened is reported once
  const { meshes: opened, materials } = await meshes;
  const reading = treeReader.read(
    opened.map((mesh, k) => ({ ...mesh, cutOut: cutsOut(materials[k]) })),
    kind,
  );
  reads?.();
  return modelOf(materials, await pictures, await reading, kind);
}
