/** The uploads of this browser, remembered in its storage: only here are they planted unasked. */
import type { TreeChange } from "../server/api";
import { PLANTED_CHOICES, type Planted, type PlantedTrees } from "../settings/planted";

export interface OwnUpload {
  readonly id: string;
  /** How it is planted here; null if its owner has removed it from the forest. */
  readonly planted: Planted | null;
  /** Whether the camera has been to the tree since it moves. */
  readonly shown: boolean;
  /** Whether its computation was started here, and so can be ended here. */
  readonly started: boolean;
}

const STORAGE_KEY = "galewood.uploads";
const VERSION = 1;
/** The oldest ones are forgotten. */
const MAX_UPLOADS = 32;

type Store = Pick<Storage, "getItem" | "setItem">;

function uploadFrom(value: unknown): OwnUpload[] {
  if (typeof value !== "object" || value === null) return [];
  const { id, planted, shown, started } = value as Record<string, unknown>;
  if (typeof id !== "string" || !/^[\w-]{1,64}$/.test(id)) return [];
  return [
    {
      id,
      planted: PLANTED_CHOICES.find((how) => how === planted) ?? null,
      shown: shown === true,
      started: started === true,
    },
  ];
}

export class OwnUploads {
  private list: OwnUpload[];
  /** Called with the id of a tree that this visitor has just uploaded. */
  onAdded: ((id: string) => void) | null = null;
  /** Ends the computation of an upload; `whole` removes the tree even if it moves by now. */
  onCancel: ((id: string, whole?: boolean) => void) | null = null;
  /** Receives the changes of a tree, and null when it starts moving. */
  private readonly watchers = new Map<string, (change: TreeChange | null) => void>();

  /** `store` may throw: storage can be blocked, and then nothing is remembered beyond this visit. */
  constructor(private readonly store: () => Store) {
    this.list = this.read();
  }

  private read(): OwnUpload[] {
    try {
      const kept: unknown = JSON.parse(this.store().getItem(STORAGE_KEY) ?? "null");
      const { version, uploads } = (kept ?? {}) as Record<string, unknown>;
      return version === VERSION && Array.isArray(uploads)
        ? uploads.flatMap(uploadFrom).slice(-MAX_UPLOADS)
        : [];
    } catch {
      return [];
    }
  }

  private keep(list: OwnUpload[]): void {
    this.list = list.slice(-MAX_UPLOADS);
    try {
      this.store().setItem(STORAGE_KEY, JSON.stringify({ version: VERSION, uploads: this.list }));
    } catch {
      // Storage is full or blocked: continue without it.
    }
  }

  /** Adds an upload as the newest one, to be planted once. `started`: its computation was started here. */
  add(id: string, started: boolean): void {
    const others = this.list.filter((upload) => upload.id !== id);
    this.keep([...others, { id, planted: "one", shown: false, started }]);
    this.onAdded?.(id);
  }

  /** Follows the computation of a tree until the returned function is called. */
  watch(id: string, watcher: (change: TreeChange | null) => void): () => void {
    this.watchers.set(id, watcher);
    return () => this.watchers.delete(id);
  }

  /** Tells a watcher of a tree what is new: null if it moves now. */
  notify(id: string, change: TreeChange | null): void {
    this.watchers.get(id)?.(change);
  }

  find(id: string): OwnUpload | null {
    return this.list.find((upload) => upload.id === id) ?? null;
  }

  /** Changes what is remembered of an upload; the uploads of others are not remembered. */
  change(id: string, change: Partial<Omit<OwnUpload, "id">>): void {
    if (!this.find(id)) return;
    this.keep(this.list.map((upload) => (upload.id === id ? { ...upload, ...change } : upload)));
  }

  forget(id: string): void {
    if (this.find(id)) this.keep(this.list.filter((upload) => upload.id !== id));
  }

  /** A forest's uploads with those of this browser; what `given` says of a tree has priority. */
  plantedWith(given: PlantedTrees): PlantedTrees {
    const own = this.list.flatMap(({ id, planted }) => (planted ? [[id, planted] as const] : []));
    return { ...Object.fromEntries(own), ...given };
  }
}
