/** Opens GLBs: compressed ones too, and such whose pictures are files of their own, which several meshes may share. */
import {
  type ImageBitmapLoader,
  Loader,
  type LoadingManager,
  type Material,
  Mesh,
  type Object3D,
  type Source,
  Texture,
} from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

/** Pictures by their address, loaded once for all meshes. */
const pictures = new Map<string, Promise<ImageBitmap>>();
/** Pictures as the graphics card keeps them, once for all textures. */
const sources = new WeakMap<ImageBitmap, Source<ImageBitmap>>();

/** Loads every picture that has an address of its own once. Has no effect on those inside of a GLB. */
class SharedPictures extends Loader<ImageBitmap> {
  readonly isImageBitmapLoader = true;

  constructor(
    private readonly inner: ImageBitmapLoader,
    private readonly missing: string[],
    manager: LoadingManager,
  ) {
    super(manager);
  }

  override load(
    url: string,
    done: (picture: ImageBitmap) => void,
    _progress?: (event: ProgressEvent) => void,
    failed?: (error: unknown) => void,
  ): void {
    const own = url.startsWith("blob:") || url.startsWith("data:");
    const picture = (own ? undefined : pictures.get(url)) ?? this.inner.loadAsync(url);
    if (!own) pictures.set(url, picture);
    picture.then(done, (error: unknown) => {
      pictures.delete(url);
      this.missing.push(url);
      failed?.(error);
    });
  }
}

/** The same picture in two textures is kept once. */
function share(texture: Texture): void {
  const { image } = texture as { image: unknown };
  if (typeof ImageBitmap === "undefined" || !(image instanceof ImageBitmap)) return;
  const known = sources.get(image);
  if (known) texture.source = known;
  else sources.set(image, texture.source as Source<ImageBitmap>);
}

function shareAll(scene: Object3D): void {
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    for (const value of Object.values(object.material as Material))
      if (value instanceof Texture) share(value);
  });
}

/**
 * The scene of a GLB; throws if it is invalid or lacks a picture. `base`: the address to which those of its pictures are
 * relative, up to the last slash.
 */
export async function openMesh(bytes: ArrayBuffer, base = ""): Promise<Object3D> {
  const missing: string[] = [];
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).register((parser) => {
    const { textureLoader, options } = parser;
    if ("isImageBitmapLoader" in textureLoader)
      parser.textureLoader = new SharedPictures(textureLoader, missing, options.manager) as never;
    return { name: "shared-pictures" };
  });
  const { scene } = await loader.parseAsync(bytes, base);
  if (missing.length > 0) throw new Error(`a picture of the tree's mesh cannot be loaded: ${missing[0]}`);
  shareAll(scene);
  return scene;
}
