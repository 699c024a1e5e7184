/** Sentences the page says. Pure. */

import type { Connection } from "../../worker/protocol";
import type { Job, Tree } from "../server/api";

const STAGES: Record<string, string> = {
  queued: "Waiting for its turn",
  import: "Reading the tree",
  meshing: "Filling it with tetrahedra",
  skeleton: "Finding its branches",
  model: "Making wood of it",
  sampling: "Letting winds blow on it",
  reducing: "Distilling the motion",
  table: "Writing the table",
  done: "Done",
};

const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

export const displayName = (tree: Pick<Tree, "name" | "species">) =>
  capital(tree.name || tree.species || "Tree");

export function timeLeft(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return "";
  if (seconds < 5) return "a few seconds left";
  if (seconds < 90) return `about ${Math.round(seconds / 5) * 5} s left`;
  return `about ${Math.round(seconds / 60)} min left`;
}

export function progressLine(job: Pick<Job, "state" | "stage" | "seconds_left">): string {
  if (job.state === "queued") return STAGES.queued;
  const left = timeLeft(job.seconds_left);
  const stage = STAGES[job.stage] ?? capital(job.stage);
  return left ? `${stage}, ${left}` : stage;
}

export function summary(trees: { moving: number; still: number }, waiting: number): string {
  if (trees.moving + trees.still === 0) {
    return waiting > 0 ? "The first trees are being computed" : "No trees yet";
  }
  const moving = `${trees.moving.toLocaleString("en")} ${trees.moving === 1 ? "tree sways" : "trees sway"}`;
  if (trees.still === 0) return `${moving}, each by its own simulated motion`;
  return `${trees.moving > 0 ? `${moving}; ` : ""}${trees.still.toLocaleString("en")} grey ones stand still until theirs is computed`;
}

export interface ServiceState {
  /** Is the stream of events open? */
  readonly events: boolean;
  readonly lookup: "worker" | "server";
  readonly connection: Connection;
}

/** Latency there and back, and the age of the newest frame in steps that can be read. */
function delays({ latency_ms, frameAge_ms }: Connection): string[] {
  const words = latency_ms === null ? [] : [`${Math.round(latency_ms)} ms`];
  if (frameAge_ms !== null) words.push(`frame ${Math.round(frameAge_ms / 10) * 10} ms old`);
  return words;
}

/** What the chip in the corner says, and its colour. */
export function statusLine(state: ServiceState): { state: string; text: string } {
  if (!state.events) return { state: "lost", text: "Server out of reach; the forest goes on here" };
  if (state.lookup === "worker") return { state: "live", text: "Lookup in this browser" };
  const { connection } = state;
  if (connection.state === "live") {
    return { state: "live", text: ["Lookup on the server", ...delays(connection)].join(", ") };
  }
  return connection.state === "lost"
    ? { state: "lost", text: "Stream lost; the forest goes on here" }
    : { state: "connecting", text: "Connecting to the stream" };
}
