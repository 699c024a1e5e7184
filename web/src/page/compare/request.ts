/** Requests a finite element simulation of one tree from the server, and polls for the result. */

import type { WindState } from "galewood/wind";
import { fetchApi, Problem } from "../server/api";
import type { Schemas } from "../server/schema";
import { decodeTracks, type Tracks } from "./tracks";

export interface Asked {
  readonly treeId: string;
  readonly wind: WindState;
  readonly x_m: number;
  readonly z_m: number;
  readonly yaw_rad: number;
  readonly start_s: number;
  readonly frames: number;
}

type Comparison = Schemas["ComparisonOut"];

export interface Waiting {
  progress(fraction: number, words: string): void;
}

const ASK_AGAIN_MS = 400;

const path = (id: string) => `api/comparisons/${encodeURIComponent(id)}`;

async function read(response: Promise<Response>): Promise<Comparison> {
  return (await (await response).json()) as Comparison;
}

function post(asked: Asked, signal: AbortSignal): Promise<Response> {
  const { treeId, ...body } = asked;
  return fetchApi(`api/trees/${encodeURIComponent(treeId)}/comparisons`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(body),
    signal,
  });
}

function words({ message, seconds_left }: Comparison): string {
  return seconds_left === null ? message : `${message}, about ${Math.ceil(seconds_left)} s left`;
}

/** The tracks; rejects with a Problem. When `signal` aborts, the simulation is cancelled. */
export async function compare(asked: Asked, waiting: Waiting, signal: AbortSignal): Promise<Tracks> {
  let now = await read(post(asked, signal));
  const stop = () => void fetchApi(`${path(now.id)}/cancel`, { method: "POST" }).catch(() => {});
  signal.addEventListener("abort", stop);
  try {
    while (!now.tracks) {
      if (now.state === "failed" || now.state === "cancelled")
        throw new Problem(now.error ?? "The comparison was cancelled.", "Repeat it.");
      waiting.progress(now.fraction, words(now));
      await new Promise((resolve) => setTimeout(resolve, ASK_AGAIN_MS));
      signal.throwIfAborted();
      now = await read(fetchApi(path(now.id), { signal }));
    }
    const answer = await fetchApi(`${path(now.id)}/tracks`, { signal });
    return decodeTracks(new Uint8Array(await answer.arrayBuffer()));
  } finally {
    signal.removeEventListener("abort", stop);
  }
}
