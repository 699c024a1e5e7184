/** Opens GLBs: compressed ones too, and such whose pictures are files of their own, which several meshes may share. */
import { type ImageBitmapLoader, type Material, Mesh, type Object3D, Texture } from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader, type GLTFParser } from "three/addons/loaders/GLTFLoader.js";

/** A picture, and the textures that show it. */
interface Picture {
  bitmap: Promise<ImageBitmap>;
  shownBy: Set<Texture>;
}

/**
 * Pictures by their address, loaded once for all meshes, until the last texture that shows one is disposed of. A cache of its own:
 * unlike whole files (`Forest`, `TableStore`), pictures are asked for by three.js while it reads a mesh, and meshes of several
 * forests share them.
 */
const pictures = new Map<string, Picture>();
/** The address that a picture came from. */
const addresses = new WeakMap<ImageBitmap, string>();
/** Colours as they are in the file. */
const AS_STORED: ImageBitmapOptions = { premultiplyAlpha: "none", colorSpaceConversion: "none" };
/** Pictures as the graphics card keeps them, once for all textures. */
const sources = new WeakMap<ImageBitmap, Texture["source"]>();

/** The same loader, which loads every picture once; `asked` receives the addresses of those that it keeps. */
function sharing(inner: ImageBitmapLoader, asked: Set<string>): ImageBitmapLoader {
  const load: ImageBitmapLoader["load"] = (url, done, _, failed) => {
    const picture = pictures.get(url) ?? { bitmap: inner.loadAsync(url), shownBy: new Set<Texture>() };
    if (url.startsWith("http")) {
      pictures.set(url, picture);
      asked.add(url);
    }
    const shown = (bitmap: ImageBitmap) => {
      if (asked.has(url)) addresses.set(bitmap, url);
      done?.(bitmap);
    };
    picture.bitmap.then(shown, (error: unknown) => {
      if (pictures.get(url) === picture) pictures.delete(url);
      failed?.(error);
    });
  };
  return Object.assign(Object.create(inner), { load });
}

/** Forgets a picture that no texture shows; what is drawn again keeps its own reference to the bitmap. */
function forgetUnshown(url: string): void {
  if (pictures.get(url)?.shownBy.size === 0) pictures.delete(url);
}

/** Keeps the picture of a texture until the texture is disposed of. */
function keepPicture(texture: Texture, image: ImageBitmap): void {
  const url = addresses.get(image);
  const picture = url === undefined ? undefined : pictures.get(url);
  if (url === undefined || !picture || picture.shownBy.has(texture)) return;
  picture.shownBy.add(texture);
  texture.addEventListener("dispose", () => {
    picture.shownBy.delete(texture);
    forgetUnshown(url);
  });
}

/**
 * Decodes the pictures inside of a GLB from its bytes. The loader would fetch them from object URLs, which a page whose
 * Content-Security-Policy lacks `connect-src blob:` forbids. The meshes do not wait for pictures, which appear in their textures.
 * Returns what is wrong with each picture, once that is known.
 */
function decoding(parser: GLTFParser): Promise<string>[] {
  const inside = new Map<number, Promise<Texture>>();
  const arriving: Promise<string>[] = [];
  const byLoader = parser.loadImageSource.bind(parser);
  const decoded = async (bufferView: number, type: string): Promise<Texture> => {
    const bytes: ArrayBuffer = await parser.getDependency("bufferView", bufferView);
    return new Texture(await createImageBitmap(new Blob([bytes], { type }), AS_STORED));
  };
  parser.loadImageSource = (index, loader) => {
    const { bufferView, mimeType, uri } = parser.json.images[index];
    let picture = inside.get(index);
    // old browsers get a loader without bitmaps, as theirs are faulty
    if (bufferView === undefined || !("isImageBitmapLoader" in loader)) picture = byLoader(index, loader);
    else if (!picture) {
      picture = decoded(bufferView, mimeType);
      inside.set(index, picture);
    }
    const texture = new Texture();
    const filled = picture.then(({ image }) => {
      texture.image = image;
      texture.needsUpdate = true;
      return "";
    });
    arriving.push(filled.catch((error: unknown) => `no picture ${uri ?? index}: ${error}`));
    return Promise.resolve(texture);
  };
  return arriving;
}

/** The same picture in two textures is kept once. */
function share(material: Material): void {
  for (const texture of Object.values(material)) {
    if (!(texture instanceof Texture)) continue;
    const image = texture.source.data as ImageBitmap;
    texture.source = sources.get(image) ?? texture.source;
    sources.set(image, texture.source);
    keepPicture(texture, image);
  }
}

/** Browsers name another directive, which allows far more. */
function explained(error: unknown): never {
  if (!(error instanceof WebAssembly.CompileError)) throw error;
  throw new Error("compressed meshes need script-src 'wasm-unsafe-eval' in the Content-Security-Policy");
}

/**
 * The scene of a GLB; throws if it is invalid or lacks a picture. `base`: the address to which those of its pictures are
 * relative, up to the last slash. `meshesThere`: called with the scene while its pictures are still on their way.
 */
export async function openMesh(
  bytes: ArrayBuffer,
  base = "",
  meshesThere?: (scene: Object3D) => void,
): Promise<Object3D> {
  let arriving: Promise<string>[] = [];
  const asked = new Set<string>();
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).register((parser) => {
    const inner = parser.textureLoader;
    if ("isImageBitmapLoader" in inner) parser.textureLoader = sharing(inner, asked);
    arriving = decoding(parser);
    return { name: "pictures" };
  });
  try {
    const { scene } = await loader.parseAsync(bytes, base).catch(explained);
    meshesThere?.(scene);
    for (const fault of await Promise.all(arriving)) if (fault) throw new Error(fault);
    scene.traverse((object) => {
      if (object instanceof Mesh) share(object.material as Material);
    });
    return scene;
  } finally {
    asked.forEach(forgetUnshown);
  }
}
