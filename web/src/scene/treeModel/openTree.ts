/** Opens the mesh of a tree with the picture of its sprays, if it names one. */
import { type OpenedMeshes, openedMeshes, openMesh } from "galewood/trees";
import { ImageBitmapLoader, SRGBColorSpace, Texture } from "three";
import { type DrawnSprays, SPRAY_TILES } from "./sprayTiles";

/** Pictures of a tree that are there. */
export interface TreePictures {
  /** Eight sprays in tiles, as `leafSprays` draws them, and single leaves; null: the tree has leaf cards only. */
  readonly sprays: Texture | null;
  /** What that picture shows; null: sprays of needles, or none. */
  readonly drawnSprays: DrawnSprays | null;
}

/** A tree whose meshes are there before its pictures. */
export interface OpeningTree {
  readonly meshes: Promise<OpenedMeshes>;
  /** Settled when the materials have their pictures. */
  readonly pictures: Promise<TreePictures>;
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
/** Points of a shoot, numbers of a leaf, and most points or leaves of one spray. */
const LEAST_SHOOT_POINTS = 2;
const LEAF_NUMBERS = 5;
const MOST_DRAWN = 64;

/** The extras of the material of the leaves of a built-in tree (precompute/galewood/pipeline/results/light.py). */
interface LeafExtras {
  readonly sprays?: unknown;
  readonly drawn_sprays?: unknown;
}

/** Read before the file is opened, so that all its pictures load at once. Empty: it has none, or is no GLB. */
function leafExtras(bytes: ArrayBuffer): LeafExtras {
  try {
    const length = new DataView(bytes).getUint32(JSON_LENGTH_BYTE, true);
    const { materials = [] }: { materials?: { extras?: LeafExtras }[] } = JSON.parse(
      new TextDecoder().decode(new Uint8Array(bytes, JSON_FROM_BYTE, length)),
    );
    return materials.map(({ extras }) => extras).find((extras) => typeof extras?.sprays === "string") ?? {};
  } catch {
    return {}; // openMesh says what is wrong
  }
}

/** What the extras say about the picture; null if that is nothing, or not what the generator writes: an upload may say anything. */
function drawnIn({ drawn_sprays: drawn }: LeafExtras): DrawnSprays | null {
  const numbers = (values: unknown, count: number) =>
    Array.isArray(values) && values.length === count && values.every(Number.isFinite);
  if (
    !isRecord(drawn) ||
    !numbers([drawn.half, drawn.petiole, drawn.petiole_m], 3) ||
    !Array.isArray(drawn.tiles)
  )
    return null;
  const whole =
    drawn.tiles.length === SPRAY_TILES.columns * SPRAY_TILES.rows &&
    drawn.tiles.every(
      (tile: unknown) =>
        isRecord(tile) &&
        isListOf(tile.shoot, LEAST_SHOOT_POINTS, (point) => numbers(point, 2)) &&
        isListOf(tile.leaves, 0, (leaf) => numbers(leaf, LEAF_NUMBERS)),
    );
  return whole ? (drawn as unknown as DrawnSprays) : null;
}

const isRecord = (value: unknown): value is Record<string, unknown> =>
  typeof value === "object" && value !== null;

const isListOf = (values: unknown, least: number, is: (value: unknown) => boolean): boolean =>
  Array.isArray(values) && values.length >= least && values.length <= MOST_DRAWN && values.every(is);

/** The picture at this address; null if it cannot be loaded. */
async function picture(url: string): Promise<Texture | null> {
  const loading = pictures.get(url) ?? load(url);
  pictures.set(url, loading);
  return loading.catch(() => {
    pictures.delete(url);
    return null;
  });
}

/** `base`: as for `openMesh`. A picture of sprays that cannot be loaded leaves the tree as it is in the file. */
export function openTree(bytes: ArrayBuffer, base: string): OpeningTree {
  const extras = leafExtras(bytes);
  const sprays = typeof extras.sprays === "string" ? picture(new URL(extras.sprays, base).href) : null;
  let take: (opened: OpenedMeshes) => void = () => undefined;
  const opened = new Promise<OpenedMeshes>((resolve) => {
    take = resolve;
  });
  const whole = openMesh(bytes, base, (scene) => take(openedMeshes(scene)));
  return {
    meshes: Promise.race([opened, whole.then(() => opened)]),
    pictures: whole.then(async () => ({ sprays: await sprays, drawnSprays: drawnIn(extras) })),
  };
}
