import { type Accessor, Document, type Material, WebIO } from "@gltf-transform/core";
import type { SurfaceMesh } from "./growth/surface";

/** Encoded textures of a species. */
export interface SpeciesPictures {
  bark: Uint8Array;
  barkNormal: Uint8Array;
  leaves: Uint8Array;
}

/** The surfaces of a tree. */
export interface TreeMeshes {
  wood: SurfaceMesh;
  twigs: SurfaceMesh;
  leaves: SurfaceMesh;
}

/** Writes binary glTF with meshes `wood`, `twigs` and `leaves`, each under a node of the same name. */
export async function writeGlb(
  name: string,
  { wood, twigs, leaves }: TreeMeshes,
  twigColour: readonly [number, number, number],
  pictures: SpeciesPictures,
): Promise<Uint8Array> {
  const document = new Document();
  document.createBuffer();
  document.getRoot().getAsset().generator = "galewood grow-species";
  const scene = document.createScene(name);
  scene.addChild(meshNode(document, "wood", wood, barkMaterial(document, pictures)));
  scene.addChild(meshNode(document, "twigs", twigs, twigMaterial(document, twigColour)));
  scene.addChild(meshNode(document, "leaves", leaves, leafMaterial(document, pictures)));
  document.getRoot().setDefaultScene(scene);
  return new WebIO().writeBinary(document);
}

/** Reads a file written by `writeGlb`. */
export function readGlb(glb: Uint8Array): Promise<Document> {
  return new WebIO().readBinary(glb);
}

function barkMaterial(document: Document, pictures: SpeciesPictures): Material {
  const texture = (name: string, image: Uint8Array) =>
    document.createTexture(name).setMimeType("image/png").setImage(image);
  return document
    .createMaterial("wood")
    .setBaseColorTexture(texture("bark", pictures.bark))
    .setNormalTexture(texture("bark_normal", pictures.barkNormal))
    .setMetallicFactor(0)
    .setRoughnessFactor(0.9);
}

/** Shoots are too thin for a texture. */
function twigMaterial(document: Document, [red, green, blue]: readonly [number, number, number]): Material {
  return document
    .createMaterial("twigs")
    .setBaseColorFactor([red, green, blue, 1])
    .setMetallicFactor(0)
    .setRoughnessFactor(0.9);
}

function leafMaterial(document: Document, pictures: SpeciesPictures): Material {
  const picture = document.createTexture("leaves").setMimeType("image/png").setImage(pictures.leaves);
  return document
    .createMaterial("leaves")
    .setBaseColorTexture(picture)
    .setMetallicFactor(0)
    .setRoughnessFactor(0.85)
    .setAlphaMode("MASK")
    .setAlphaCutoff(0.4)
    .setDoubleSided(true);
}

function meshNode(document: Document, name: string, mesh: SurfaceMesh, material: Material) {
  const accessor = (
    type: "SCALAR" | "VEC2" | "VEC3" | "VEC4",
    array: Float32Array | Uint16Array | Uint8Array,
  ): Accessor =>
    document
      .createAccessor()
      .setType(type)
      .setArray(array as never);
  const primitive = document
    .createPrimitive()
    .setIndices(accessor("SCALAR", new Uint16Array(mesh.indices)))
    .setAttribute("POSITION", accessor("VEC3", new Float32Array(mesh.positions)))
    .setAttribute("NORMAL", accessor("VEC3", new Float32Array(mesh.normals)))
    .setMaterial(material);
  if (mesh.uvs.length > 0) primitive.setAttribute("TEXCOORD_0", accessor("VEC2", new Float32Array(mesh.uvs)));
  if (mesh.colours)
    primitive.setAttribute("COLOR_0", accessor("VEC4", colourBytes(mesh.colours)).setNormalized(true));
  return document.createNode(name).setMesh(document.createMesh(name).addPrimitive(primitive));
}

/** Opaque RGBA bytes: four per vertex, for the alignment required by glTF. */
function colourBytes(rgb: readonly number[]): Uint8Array {
  const bytes = new Uint8Array((rgb.length / 3) * 4).fill(255);
  rgb.forEach((value, i) => {
    bytes[Math.floor(i / 3) * 4 + (i % 3)] = Math.round(255 * value);
  });
  return bytes;
}
