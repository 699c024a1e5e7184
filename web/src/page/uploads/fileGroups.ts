/** Which of the chosen or dropped files belong together: a mesh with its buffers and textures becomes one ZIP archive. */

import { loadPart } from "../server/connected";

/** A file and its path, which for dropped folders begins with the folder's name. */
export interface Chosen {
  readonly path: string;
  readonly file: File;
}

const MODEL_PATTERN = /\.(glb|gltf|obj|ply|stl|fbx|dae|3ds|zip|mat|csv)$/i;
const COMPANION_PATTERN = /\.(bin|mtl|png|jpe?g|webp|ktx2|tga|bmp|tiff?|dds)$/i;
/** Files that compression does not make smaller. */
const PACKED_PATTERN = /\.(png|jpe?g|webp|ktx2|glb|zip)$/i;

/** Files to send together. Without textures or buffers every file is a tree of its own. Pure. */
export function grouped(chosen: readonly Chosen[]): Chosen[][] {
  const models = chosen.filter(({ path }) => MODEL_PATTERN.test(path));
  const companions = chosen.filter(({ path }) => COMPANION_PATTERN.test(path));
  if (models.length > 0 && companions.length > 0) return [[...models, ...companions]];
  const folder = chosen.some(({ path }) => path.includes("/"));
  return (folder && models.length > 0 ? models : chosen).map((one) => [one]);
}

/** The file to upload for a group: itself if it is alone, else a ZIP archive named after its model. */
export async function uploadOf(group: readonly Chosen[]): Promise<File> {
  const [first] = group;
  if (!first) throw new Error("an empty group");
  if (group.length === 1) return first.file;
  const { zipSync } = await loadPart(() => import("three/examples/jsm/libs/fflate.module.js"));
  const entries: Record<string, [Uint8Array, { level: 0 | 1 }]> = {};
  for (const { path, file } of group) {
    entries[path] = [new Uint8Array(await file.arrayBuffer()), { level: PACKED_PATTERN.test(path) ? 0 : 1 }];
  }
  const name = first.path.replace(/^.*\//, "").replace(/\.[^.]*$/, "");
  return new File([zipSync(entries) as Uint8Array<ArrayBuffer>], `${name}.zip`, { type: "application/zip" });
}

/** Files chosen with the button. */
export const chosenFiles = (files: Iterable<File>): Chosen[] =>
  [...files].map((file) => ({ path: file.name, file }));

/** Files and the contents of folders dropped on the page. Call it during the event: the list is emptied afterwards. */
export async function droppedFiles(transfer: DataTransfer): Promise<Chosen[]> {
  const entries = [...transfer.items].map((item) => (item.kind === "file" ? item.webkitGetAsEntry() : null));
  const plain = chosenFiles(transfer.files);
  if (!entries.some((entry) => entry?.isDirectory)) return plain;
  const found = await Promise.all(entries.map((entry) => (entry ? filesOf(entry) : [])));
  return found.flat();
}

async function filesOf(entry: FileSystemEntry): Promise<Chosen[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((take, fail) => (entry as FileSystemFileEntry).file(take, fail));
    return [{ path: entry.fullPath.replace(/^\//, ""), file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: Chosen[] = [];
  for (;;) {
    // a reader gives at most a hundred entries at a time
    const some = await new Promise<FileSystemEntry[]>((take, fail) => reader.readEntries(take, fail));
    if (some.length === 0) return found;
    for (const one of some) found.push(...(await filesOf(one)));
  }
}
