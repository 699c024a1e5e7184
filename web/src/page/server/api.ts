/** Client of the server's REST API. */

import type { Form } from "../../scene/forms";
import { type Sending, sendBody } from "./sending";

export type TreeState = "uploaded" | "building" | "preliminary" | "ready" | "failed";
export type JobState = "queued" | "running" | "done" | "failed" | "cancelled";

export interface Tree {
  id: string;
  name: string;
  species: string | null;
  builtin: boolean;
  /** Grown in the open, or slender between other trees; a built-in species may have both. */
  form?: Form;
  state: TreeState;
  height_m: number | null;
  table_sha256: string | null;
  /** The table of the same mesh without its leaves, for the winter. */
  bare_table_sha256?: string | null;
  /** Records of the paper's method that belong to the table; a table may also hold them itself. */
  records_sha256?: string | null;
  /** How the tree yields to forces at its points; fetched when it is pulled. */
  compliance_sha256?: string | null;
  mesh_sha256: string | null;
  job_id: string | null;
  created_at: string;
  /** Changes with every change of the tree, also of its report. */
  updated_at: string;
}

/** A tree with the report of its import and its build, as one is asked for; lists and events have none. */
export interface ReportedTree extends Tree {
  report: Record<string, unknown> | null;
}

export interface Job {
  id: string;
  tree_id: string;
  state: JobState;
  stage: string;
  fraction: number;
  message: string;
  seconds_left: number | null;
  /** Names and hashes of the pictures that the build has published so far. */
  pictures?: Record<string, string>;
  error: { title?: string; hint?: string } | string | null;
}

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
    throw new Problem("The server cannot be reached.", "Check that it is running, then try again.");
  }
}

/** Sends a request; throws a Problem on failure. Only requests that change something carry the key. */
export async function fetchApi(
  path: string,
  init?: RequestInit,
  by: Send = (to, given) => fetch(to, given),
): Promise<Response> {
  const writes = init?.method !== undefined && init.method !== "GET";
  let response = await send(by, path, init, writes ? keys.known() : null);
  if (response.status === 401) {
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

/** What can be chosen about a computation; null: the default. */
export interface BuildSettings {
  /** First frequency to which the stiffness is scaled. */
  first_frequency_hz?: number | null;
}

export async function startPrecompute(treeId: string, settings: BuildSettings = {}): Promise<Job> {
  const path = `api/trees/${encodeURIComponent(treeId)}/precompute`;
  const body = JSON.stringify({ settings });
  const init = { method: "POST", headers: { "content-type": "application/json" }, body };
  return (await (await fetchApi(path, init)).json()) as Job;
}

/** Corrections of an upload; null restores the detected value. */
export interface Assumptions {
  name?: string | null;
  species?: string | null;
  height_m?: number | null;
  up_axis?: string | null;
  /** Names or ids of pieces, like the two lists below. */
  wood_materials?: string[] | null;
  leaves?: string[] | null;
  drop?: string[] | null;
  /** Which tree of a file with several. */
  tree?: number | null;
  /** Whether wood is added where foliage has none. */
  complete?: boolean | null;
  /** Of a scanned tree, like the fields below: diameter of the trunk at 1.3 m. */
  dbh_cm?: number | null;
  min_radius_mm?: number | null;
  bare?: boolean | null;
}

/** Imports the mesh again with these corrections. */
export async function changeAssumptions(treeId: string, assumptions: Assumptions): Promise<ReportedTree> {
  const init = {
    method: "PATCH",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(assumptions),
  };
  return (await (await fetchApi(`api/trees/${encodeURIComponent(treeId)}`, init)).json()) as ReportedTree;
}

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
  const init = {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(changes),
  };
  return (await (
    await fetchApi(`api/trees/${encodeURIComponent(treeId)}/copies`, init)
  ).json()) as ReportedTree;
}

export async function deleteTree(treeId: string): Promise<void> {
  await fetchApi(`api/trees/${encodeURIComponent(treeId)}`, { method: "DELETE" });
}

/** The wood species that a tree can be assigned. */
export async function knownSpecies(): Promise<{ id: string; name: string }[]> {
  const answer = (await (await fetchApi("api/species")).json()) as {
    species: { id: string; name: string }[];
  };
  return answer.species;
}

/** Names and hashes of the pictures of a job. */
export async function jobPictures(jobId: string): Promise<Record<string, string>> {
  const job = (await (await fetchApi(`api/jobs/${encodeURIComponent(jobId)}`)).json()) as Job;
  return job.pictures ?? {};
}

/** URL of a picture of a job. */
export const pictureUrl = (jobId: string, name: string, sha256: string) =>
  `api/jobs/${encodeURIComponent(jobId)}/pictures/${encodeURIComponent(name)}?${sha256.slice(0, 8)}`;

/** Ends a build. What it has published so far is kept. */
export async function cancelJob(jobId: string): Promise<void> {
  await fetchApi(`api/jobs/${encodeURIComponent(jobId)}/cancel`, { method: "POST" });
}

export const tableUrl = (sha256: string) => `api/tables/${sha256}`;

export const complianceUrl = (sha256: string) => `api/compliances/${sha256}`;

export const recordsUrl = (sha256: string) => `api/records/${sha256}`;

export async function fetchMesh(sha256: string): Promise<ArrayBuffer> {
  return (await fetchApi(`api/meshes/${sha256}`)).arrayBuffer();
}
