/** Texts of the page: progress, summary and status lines. Pure. */

import type { Connection, TableMotion } from "galewood/client";
import { isActive, type Job, type Tree } from "../server/api";

const NUMBERS = new Intl.NumberFormat("en"); // Number.toLocaleString takes many times as long

/** A number without decimals, thousands set apart. */
export const whole = (value: number): string => NUMBERS.format(Math.round(value));

const STAGES: Record<string, string> = {
  queued: "Waiting in the queue",
  import: "Importing the mesh",
  meshing: "Generating tetrahedra",
  skeleton: "Extracting the skeleton",
  model: "Assigning material",
  sampling: "Simulating winds",
  reducing: "Reducing the model",
  table: "Writing the table",
  records: "Computing the paper's method",
  bare: "Computing the tree without its leaves",
  done: "Done",
};

export const capital = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

export const displayName = (tree: Pick<Tree, "name" | "species">) =>
  capital(tree.name || tree.species || "Tree");

/** How complete a tree's table is, and what a preliminary one leaves out. */
export function tableWords(
  motion: Pick<TableMotion, "preliminary" | "linear" | "leftOut" | "foliage"> | null,
  job: Job | null,
  loading = false,
): string {
  if (!motion) return loading ? "Its table is being loaded." : "No motion yet.";
  if (!motion.preliminary)
    return motion.foliage === "bare" ? "Complete table, without leaves." : "Complete table.";
  const follows = isActive(job) ? "; the full table follows" : "";
  const kind = motion.linear ? "First motion from the natural modes" : "Preliminary table";
  const without = motion.leftOut.length > 0 ? ` It leaves out: ${motion.leftOut.join("; ")}.` : "";
  return `${kind}${follows}.${without}`;
}

export function timeLeft(seconds: number | "late" | null): string {
  if (seconds === "late") return "longer than expected";
  if (seconds === null || !Number.isFinite(seconds)) return "";
  if (seconds < 5) return "a few seconds left";
  if (seconds < 90) return `about ${Math.round(seconds / 5) * 5} s left`;
  return `about ${Math.round(seconds / 60)} min left`;
}

export function progressLine(
  job: Pick<Job, "state" | "stage"> & { seconds_left: number | "late" | null },
): string {
  if (job.state === "queued") return STAGES.queued;
  const left = timeLeft(job.seconds_left);
  const stage = STAGES[job.stage] ?? capital(job.stage);
  return left ? `${stage}, ${left}` : stage;
}

/** What the summary needs to know of the server's list of trees. */
export interface ListedTrees {
  /** Whether the list has arrived. */
  readonly known: boolean;
  /** Number of trees whose motion is being computed, and of those whose files are being fetched. */
  readonly computing: number;
  readonly loading: number;
}

/** `still` are the trees without motion, of which `loading` only wait for their files. */
export function summary(
  trees: { moving: number; still: number; loading: number },
  listed: ListedTrees,
): string {
  if (trees.moving + trees.still === 0) {
    if (!listed.known || listed.loading > 0) return "Loading the trees";
    return listed.computing > 0 ? "The first trees are being computed" : "No trees yet";
  }
  const moving = `${whole(trees.moving)} ${trees.moving === 1 ? "tree" : "trees"}`;
  if (trees.still === 0)
    return trees.moving === 1 ? `${moving}, moving` : `${moving}, each with its own simulated motion`;
  const missing = [
    countWords(trees.still - trees.loading, "not computed yet"),
    countWords(trees.loading, "loading"),
  ].filter((words) => words !== "");
  return [...(trees.moving > 0 ? [`${moving} moving`] : []), ...missing].join(", ");
}

const countWords = (count: number, state: string) =>
  count === 0 ? "" : `${whole(count)} ${count === 1 ? "tree" : "trees"} ${state}`;

export interface ServiceState {
  /** Whether the event stream is open. */
  readonly events: boolean;
  readonly lookup: "worker" | "server";
  readonly connection: Connection;
}

/** Round-trip latency, and the age of the newest frame rounded to 10 ms for readability. */
function delays({ latency_ms, frameAge_ms }: Connection): string[] {
  const words = latency_ms === null ? [] : [`${Math.round(latency_ms)} ms`];
  if (frameAge_ms !== null) words.push(`frame ${Math.round(frameAge_ms / 10) * 10} ms old`);
  return words;
}

/** Text and colour of the status line. */
export function statusLine(state: ServiceState): { state: string; text: string } {
  if (!state.events) return { state: "lost", text: "Server unreachable; computing in this browser" };
  if (state.lookup === "worker") return { state: "live", text: "Computed in this browser" };
  const { connection } = state;
  if (connection.state === "live") {
    return { state: "live", text: ["Computed on the server", ...delays(connection)].join(", ") };
  }
  return connection.state === "lost"
    ? { state: "lost", text: "Stream lost; computing in this browser" }
    : { state: "connecting", text: "Connecting to the server" };
}
