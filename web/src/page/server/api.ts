/** Client of the server's REST API. */

import type { TreeModel } from "galewood/trees";
import { readTreeModel } from "../../scene/treeModel/readTreeModel";
import type { TreeKind } from "../../scene/treeModel/treeArrays";
import type { Schemas } from "./schema";
import { type Sending, sendBody } from "./sending";

export type Tree = Schemas["TreeSummary"];
/** A tree with the report of its import and its build, as one is asked for; lists and events have none. */
export type ReportedTree = Schemas["TreeOut"];
export type IndividualOrder = Schemas["IndividualOrder"];
export type Job = Schemas["JobOut"];
/** Corrections of an upload; null restores the detected value. */
export type Assumptions = Schemas["TreeChanges"];
export type BuildSettings = Schemas["BuildSettings"];
type WoodSpecies = Schemas["WoodSpeciesOut"];

export const isActive = (job: Job | null): job is Job => job?.state === "queued" || job?.state === "running";

export interface TreeChange {
  tree: Tree;
  job: Job | null;
  /** The tree was removed. */
  deleted?: boolean;
}

/** A server problem (RFC 9457) or network error, with a readable title and hint. */
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

/** The server did not answer. */
export class Disconnected extends Problem {
  constructor() {
    super("The server is not connected.", "Check that it is running, then try again.");
  }
}

const text = (value: unknown, fallback: string) => (typeof value === "string" && value ? value : fallback);

/** The problem in a response; other bodies, such as a proxy's HTML page, give a generic message. */
export async function problemFrom(response: Response): Promise<Problem> {
  const body = (await response.json().catch(() => ({}))) as Record<string, unknown>;
  const title = text(body.title, `The server responded with status ${response.status}.`);
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

/** A server that has not said that it is well after this time is gone. */
const ANSWERS_WITHIN_MS = 8000;

type Send = (path: string, init: RequestInit) => Promise<Response>;

async function send(
  by: Send,
  path: string,
  init: RequestInit | undefined,
  key: string | null,
): Promise<Response> {
  const headers = new Headers(init?.headers);
  if (key) headers.set("authorization", `Bearer ${key}`);
  try {
    return await by(path, { ...init, headers });
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new Disconnected();
  }
}

/**
 * Sends a request; throws a Problem on failure. Only requests that change something carry the key, for which the visitor
 * is asked unless `asks` is false.
 */
export async function fetchApi(
  path: string,
  init?: RequestInit,
  by: Send = (to, given) => fetch(to, given),
  asks = true,
): Promise<Response> {
  const writes = init?.method !== undefined && init.method !== "GET";
  let response = await send(by, path, init, writes ? keys.known() : null);
  if (response.status === 401 && asks) {
    const key = await keys.ask();
    if (key) response = await send(by, path, init, key);
  }
  if (!response.ok) throw await problemFrom(response);
  return response;
}

/**
 * Uploads a mesh. The server imports it immediately and rejects files that are not usable as a tree. Throws an
 * AbortError once `sending` was ended.
 */
export async function uploadTree(file: File, sending: Sending): Promise<ReportedTree> {
  const form = new FormData();
  form.append("file", file, file.name);
  const init = { method: "POST", body: form };
  const response = await fetchApi("api/trees", init, (to, given) => sendBody(to, given, sending));
  return (await response.json()) as ReportedTree;
}

export async function fetchTree(id: string): Promise<ReportedTree> {
  return (await (await fetchApi(`api/trees/${encodeURIComponent(id)}`)).json()) as ReportedTree;
}

const jsonBody = (body: unknown): RequestInit => ({
  method: "POST",
  headers: { "content-type": "application/json" },
  body: JSON.stringify(body),
});

/** An individual as the page asks for it: always of a size that its species can have. */
const ofNearestSize = (order: IndividualOrder): IndividualOrder => ({ ...order, nearest_size: true });

/**
 * Asks for an individual of a built-in species, which a job makes unless it is there. `asks`: whether the visitor may be
 * asked for the key of the server.
 */
export async function growIndividual(order: IndividualOrder, asks: boolean): Promise<Tree> {
  const init = jsonBody(ofNearestSize(order));
  return (await (await fetchApi("api/individuals", init, undefined, asks)).json()) as Tree;
}

/** The individuals that have been made already, and why the server could make no others. */
export async function findIndividuals(
  orders: readonly IndividualOrder[],
): Promise<Schemas["FoundIndividuals"]> {
  const init = jsonBody({ individuals: orders.map(ofNearestSize) });
  return (await (await fetchApi("api/individuals/find", init)).json()) as Schemas["FoundIndividuals"];
}

/** Queues the computation of a tree's table. */
export async function startBuild(treeId: string, settings: BuildSettings = {}): Promise<Job> {
  const init = jsonBody({ tree_id: treeId, settings });
  return (await (await fetchApi("api/jobs", init)).json()) as Job;
}

/** Imports the mesh again with these corrections. */
export async function changeAssumptions(treeId: string, assumptions: Assumptions): Promise<ReportedTree> {
  const init = { ...jsonBody(assumptions), method: "PATCH" };
  return (await (await fetchApi(`api/trees/${encodeURIComponent(treeId)}`, init)).json()) as ReportedTree;
}

/** A picture of a tree in its own colours; another mesh has another address. */
export const thumbnailUrl = ({ id, mesh_sha256 }: { id: string; mesh_sha256: string | null }): string =>
  `api/trees/${encodeURIComponent(id)}/thumbnail?version=${mesh_sha256?.slice(0, 12) ?? ""}`;

/** All pieces of an upload's tree as a GLB, also those that are left out. */
export async function fetchPieces(treeId: string): Promise<ArrayBuffer> {
  const path = `api/trees/${encodeURIComponent(treeId)}/pieces`;
  return (await fetchApi(path, { method: "POST" })).arrayBuffer();
}

/** Imports the file of an upload once more, as a tree of its own, with these changes. */
export async function copyTree(
  treeId: string,
  changes: Assumptions & { readonly name: string },
): Promise<ReportedTree> {
  const path = `api/trees/${encodeURIComponent(treeId)}/copies`;
  return (await (await fetchApi(path, jsonBody(changes))).json()) as ReportedTree;
}

export async function deleteTree(treeId: string): Promise<void> {
  await fetchApi(`api/trees/${encodeURIComponent(treeId)}`, { method: "DELETE" });
}

/** The wood species that a tree can be assigned. */
export async function knownSpecies(): Promise<WoodSpecies[]> {
  const answer = (await (await fetchApi("api/species")).json()) as Schemas["WoodSpeciesList"];
  return answer.species;
}

/** Names and hashes of the pictures of a job. */
export async function jobPictures(jobId: string): Promise<Record<string, string>> {
  const job = (await (await fetchApi(`api/jobs/${encodeURIComponent(jobId)}`)).json()) as Job;
  return job.pictures ?? {};
}

/** URL of a picture of a job. */
export const pictureUrl = (jobId: string, name: string, sha256: string) =>
  `api/jobs/${encodeURIComponent(jobId)}/pictures/${encodeURIComponent(name)}?version=${sha256.slice(0, 8)}`;

/** Ends a build. What it has published so far is kept. */
export async function cancelJob(jobId: string): Promise<void> {
  await fetchApi(`api/jobs/${encodeURIComponent(jobId)}/cancel`, { method: "POST" });
}

/** Rejects with a Problem unless a server with a service is connected. */
export async function findService(): Promise<void> {
  await fetchApi("healthz", { signal: AbortSignal.timeout(ANSWERS_WITHIN_MS) });
}

export const tableUrl = (sha256: string) => `api/tables/${sha256}`;

export const complianceUrl = (sha256: string) => `api/compliances/${sha256}`;

export const recordsUrl = (sha256: string) => `api/records/${sha256}`;

/** The mesh of a tree, in its light copy if it has one. `reads`: called when it is there, and is being read. */
export async function fetchModel(sha256: string, kind: TreeKind, reads?: () => void): Promise<TreeModel> {
  const path = `api/light-meshes/${sha256}`;
  const bytes = await (await fetchApi(path)).arrayBuffer();
  return readTreeModel(bytes, new URL(".", new URL(path, document.baseURI)).href, kind, reads);
}
