/** Opens the mesh of a tree with the picture of its sprays, if it names one. */
import { openMesh } from "galewood/trees";
import { ImageBitmapLoader, type Object3D, SRGBColorSpace, Texture } from "three";

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

/** Where the JSON of a GLB begins, after the headers of the file and of its first chunk, and where its length is (glTF 2.0, 4.4). */
const JSON_FROM_BYTE = 20;
const JSON_LENGTH_BYTE = 12;

/**
 * The address of the picture, which the material of the leaves has in its extras: read before the file is opened, so that all its
 * pictures load at once. null: it has none, or is no GLB.
 */
function spraysIn(bytes: ArrayBuffer): string | null {
  try {
    const length = new DataView(bytes).getUint32(JSON_LENGTH_BYTE, true);
    const { materials = [] }: { materials?: { extras?: { sprays?: unknown } }[] } = JSON.parse(
      new TextDecoder().decode(new Uint8Array(bytes, JSON_FROM_BYTE, length)),
    );
    const found = materials.map(({ extras }) => extras?.sprays).find((sprays) => typeof sprays === "string");
    return found ?? null;
  } catch {
    return null; // openMesh says what is wrong
  }
}

/** The picture at this address; null if it cannot be loaded. */
async function picture(url: string): Promise<Texture | null> {
  const loading = pictures.get(url) ?? load(url);
  pictures.set(url, loading);
  return loading.catch(() => {
    pictures.delete(url);
    return null;
  });
}

/** `base`: as for `openMesh`. A picture that cannot be loaded leaves the tree as it is in the file. */
export async function openTree(bytes: ArrayBuffer, base: string): Promise<OpenedTree> {
  const address = spraysIn(bytes);
  const sprays = address === null ? null : picture(new URL(address, base).href);
  return { scene: await openMesh(bytes, base), sprays: await sprays };
}
