/** Opens the mesh of a tree with the picture of its sprays, if it names one. */
import { openMesh } from "galewood/trees";
import { ImageBitmapLoader, Mesh, type Object3D, SRGBColorSpace, Texture } from "three";

export interface OpenedTree {
  readonly scene: Object3D;
  /** Eight sprays in tiles, as `leafSprays` draws them; null: the tree has leaf cards only. */
  readonly sprays: Texture | null;
}

/** The pictures of the built-in species by their address, which the forms of a species share until one is disposed of. */
const pictures = new Map<string, Promise<Texture>>();

async function load(url: string): Promise<Texture> {
  const loader = new ImageBitmapLoader();
  loader.setOptions({ premultiplyAlpha: "none", colorSpaceConversion: "none" });
  const texture = new Texture(await loader.loadAsync(url));
  texture.flipY = false; // as in glTF
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  texture.addEventListener("dispose", () => pictures.delete(url));
  return texture;
}

/** The address of the picture, which the material of the leaves has in its extras. */
function spraysIn(scene: Object3D): string | null {
  let found: string | null = null;
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const { sprays } = (object.material as { userData: { sprays?: unknown } }).userData;
    if (typeof sprays === "string") found = sprays;
  });
  return found;
}

/** `base`: as for `openMesh`. A picture that cannot be loaded leaves the tree as it is in the file. */
export async function openTree(bytes: ArrayBuffer, base: string): Promise<OpenedTree> {
  const scene = await openMesh(bytes, base);
  const address = spraysIn(scene);
  if (address === null) return { scene, sprays: null };
  const url = new URL(address, base).href;
  const picture = pictures.get(url) ?? load(url);
  pictures.set(url, picture);
  const sprays = await picture.catch(() => {
    pictures.delete(url);
    return null;
  });
  return { scene, sprays };
}
