/** Opens GLBs: compressed ones too, and such whose pictures are files of their own, which several meshes may share. */
import { type ImageBitmapLoader, type Material, Mesh, type Object3D, type Texture } from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

/** Pictures by their address, loaded once for all meshes. */
const pictures = new Map<string, Promise<ImageBitmap>>();
/** Pictures as the graphics card keeps them, once for all textures. */
const sources = new WeakMap<ImageBitmap, Texture["source"]>();

/** The same loader for pictures inside of a GLB; one with an address of its own is loaded once. Adds those that fail to `missing`. */
function sharing(inner: ImageBitmapLoader, missing: string[]): ImageBitmapLoader {
  const load: ImageBitmapLoader["load"] = (url, done, _, failed) => {
    const picture = pictures.get(url) ?? inner.loadAsync(url);
    if (url.startsWith("http")) pictures.set(url, picture);
    picture.then(done, (error: unknown) => {
      pictures.delete(url);
      missing.push(url);
      failed?.(error);
    });
  };
  return Object.assign(Object.create(inner), { load });
}

/** The same picture in two textures is kept once. */
function share(material: Material): void {
  for (const texture of Object.values(material) as (Partial<Texture> | null)[]) {
    if (!texture?.source) continue;
    const image = texture.source.data as ImageBitmap;
    texture.source = sources.get(image) ?? texture.source;
    sources.set(image, texture.source);
  }
}

/**
 * The scene of a GLB; throws if it is invalid or lacks a picture. `base`: the address to which those of its pictures are
 * relative, up to the last slash.
 */
export async function openMesh(bytes: ArrayBuffer, base = ""): Promise<Object3D> {
  const missing: string[] = [];
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).register((parser) => {
    const inner = parser.textureLoader;
    if ("isImageBitmapLoader" in inner) parser.textureLoader = sharing(inner, missing);
    return { name: "pictures" };
  });
  const { scene } = await loader.parseAsync(bytes, base);
  if (missing[0]) throw new Error(`no picture ${missing[0]}`);
  scene.traverse((object) => {
    if (object instanceof Mesh) share(object.material as Material);
  });
  return scene;
}
