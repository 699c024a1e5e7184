/** The REST interface of the server, as this page uses it. */

export type TreeState = "uploaded" | "building" | "preliminary" | "ready" | "failed";
export type JobState = "queued" | "running" | "done" | "failed" | "cancelled";

export interface Tree {
  id: string;
  name: string;
  species: string | null;
  builtin: boolean;
  state: TreeState;
  height_m: number | null;
  table_sha256: string | null;
  mesh_sha256: string | null;
  job_id: string | null;
  report: Record<string, unknown> | null;
  created_at: string;
}

export interface Job {
  id: string;
  tree_id: string;
  state: JobState;
  stage: string;
  fraction: number;
  message: string;
  seconds_left: number | null;
  /** Name and hash of what the build has drawn so far. */
  pictures?: Record<string, string>;
  error: { title?: string; hint?: string } | string | null;
}

export interface TreeChange {
  tree: Tree;
  job: Job | null;
  /** The tree was removed. */
  deleted?: boolean;
}

/** An error of the server (RFC 9457) or the network, in plain words. */
export class Problem extends Error {
  constructor(
    readonly title: string,
    readonly hint: string,
    readonly status = 0,
  ) {
    super(title);
    this.name = "Problem";
  }
}

const text = (value: unknown, fallback: string) => (typeof value === "string" && value ? value : fallback);

/** The problem that an answer carries; a proxy's HTML page becomes a plain sentence. */
export async function problemFrom(response: Response): Promise<Problem> {
  const body = (await response.json().catch(() => ({}))) as Record<string, unknown>;
  const title = text(body.title, `The server answered ${response.status}.`);
  const hint = text(body.hint, text(body.detail, "Try again in a moment."));
  return new Problem(title, hint, response.status);
}

/** Supplies the server's key: the known one, or one entered by the visitor. */
export interface KeyRing {
  known(): string | null;
  ask(): Promise<string | null>;
}

let keys: KeyRing = { known: () => null, ask: async () => null };

export function useKeys(ring: KeyRing): void {
  keys = ring;
}

async function send(path: string, init: RequestInit | undefined, key: string | null): Promise<Response> {
  const headers = new Headers(init?.headers);
  if (key) headers.set("authorization", `Bearer ${key}`);
  try {
    return await fetch(path, { ...init, headers });
  } catch {
    throw new Problem("The server cannot be reached.", "Check that it is running, then try again.");
  }
}

/** Sends a request; throws a Problem on failure. Only requests that change something carry the key. */
export async function fetchApi(path: string, init?: RequestInit): Promise<Response> {
  const writes = init?.method !== undefined && init.method !== "GET";
  let response = await send(path, init, writes ? keys.known() : null);
  if (response.status === 401) {
    const key = await keys.ask();
    if (key) response = await send(path, init, key);
  }
  if (!response.ok) throw await problemFrom(response);
  return response;
}

/** Uploads a mesh; the server reads it at once and refuses what is no tree. */
export async function uploadTree(file: File): Promise<Tree> {
  const form = new FormData();
  form.append("file", file, file.name);
  return (await (await fetchApi("api/trees", { method: "POST", body: form })).json()) as Tree;
}

export async function startPrecompute(treeId: string): Promise<Job> {
  const path = `api/trees/${encodeURIComponent(treeId)}/precompute`;
  const init = { method: "POST", headers: { "content-type": "application/json" }, body: "{}" };
  return (await (await fetchApi(path, init)).json()) as Job;
}

/** What a visitor says of an upload; null leaves it to the server again. */
export interface Assumptions {
  species?: string | null;
  height_m?: number | null;
  up_axis?: string | null;
  wood_materials?: string[] | null;
}

/** The mesh is read again under other assumptions. */
export async function changeAssumptions(treeId: string, assumptions: Assumptions): Promise<Tree> {
  const init = {
    method: "PATCH",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(assumptions),
  };
  return (await (await fetchApi(`api/trees/${encodeURIComponent(treeId)}`, init)).json()) as Tree;
}

export async function deleteTree(treeId: string): Promise<void> {
  await fetchApi(`api/trees/${encodeURIComponent(treeId)}`, { method: "DELETE" });
}

/** The woods that a tree can be given. */
export async function knownSpecies(): Promise<{ id: string; name: string }[]> {
  const answer = (await (await fetchApi("api/species")).json()) as {
    species: { id: string; name: string }[];
  };
  return answer.species;
}

/** Names and hashes of the pictures that a job has drawn. */
export async function jobPictures(jobId: string): Promise<Record<string, string>> {
  const job = (await (await fetchApi(`api/jobs/${encodeURIComponent(jobId)}`)).json()) as Job;
  return job.pictures ?? {};
}

/** A picture of a job on its way. */
export const pictureUrl = (jobId: string, name: string, sha256: string) =>
  `api/jobs/${encodeURIComponent(jobId)}/pictures/${encodeURIComponent(name)}?${sha256.slice(0, 8)}`;

export const tableUrl = (sha256: string) => `api/tables/${sha256}`;

export async function fetchMesh(sha256: string): Promise<ArrayBuffer> {
  return (await fetchApi(`api/meshes/${sha256}`)).arrayBuffer();
}

export interface EventHandlers {
  change(change: TreeChange): void;
  open(): void;
  lost(): void;
}

const EVENTS_AGAIN_MS = 1000;

/** Every tree as it stands, then every change; reconnects by itself. Returns what ends it. */
export function followEvents(handlers: EventHandlers): () => void {
  let source: EventSource | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const connect = () => {
    source = new EventSource("api/events");
    source.onmessage = (event: MessageEvent<string>) => handlers.change(JSON.parse(event.data) as TreeChange);
    source.onopen = () => handlers.open();
    source.onerror = () => {
      // Browsers wait seconds before they try again, and give up after some answers: do it here.
      source?.close();
      handlers.lost();
      timer = setTimeout(connect, EVENTS_AGAIN_MS);
    };
  };
  connect();
  return () => {
    clearTimeout(timer);
    source?.close();
  };
}
