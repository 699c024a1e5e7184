/** The worker: decodes tables and keeps the pose of every tree, computed here or received from the server. */

import { poseStride } from "../core/motion/poseStride";
import { decodeTable, type Table } from "../core/table/table";
import { parseState, sampledPeak, type WindDocument, WindField } from "../core/wind/wind";
import type { Reply } from "../core/wire/wire";
import { JumpBlend } from "./motion/blend";
import { carryGroup, type ShownGroup } from "./motion/carry";
import { FailoverMotion } from "./motion/failover";
import { LocalMotion } from "./motion/localMotion";
import type { MotionSource } from "./motion/motionSource";
import { SharedMotion } from "./motion/sharedMotion";
import { StreamMotion } from "./motion/streamMotion";
import type { ForestPlan, FromWorker, GroupPlan, ToWorker, TreeAt } from "./protocol";
import { forestRequest } from "./stream/forestRequest";
import { motionBuffers, tableMotion } from "./table/tableMotion";

const scope = self as unknown as {
  onmessage: (event: MessageEvent<ToWorker>) => void;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
};

const tables = new Map<string, Table>();
const tableBytes = new Map<string, number>();
const blend = new JumpBlend();
let source: MotionSource | null = null;
let field: WindField | null = null;
let epoch = 0;
/** The displayed poses, which the next plan starts from. */
let shown: Float32Array[] = [];
let shownGroups: readonly ShownGroup[] = [];
let watched: TreeAt | null = null;

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));
const problem = (title: string, hint: string) => scope.postMessage({ kind: "problem", title, hint });

async function load(sha256: string, url: string): Promise<void> {
  try {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`the server responded with status ${response.status}`);
    const bytes = await response.arrayBuffer();
    const table = decodeTable(bytes);
    tables.set(sha256, table);
    tableBytes.set(sha256, bytes.byteLength);
    const motion = tableMotion(sha256, table, bytes.byteLength);
    scope.postMessage({ kind: "table", motion }, motionBuffers(motion));
  } catch (error) {
    scope.postMessage({ kind: "tableFailed", sha256, title: `A table could not be read: ${reason(error)}` });
  }
}

function tableOf({ table }: GroupPlan): Table {
  const found = tables.get(table);
  if (!found) throw new Error(`table ${table} is used before it was loaded`);
  return found;
}

function makeSource(plan: ForestPlan, wind: WindDocument, socketUrl: string): MotionSource {
  const time_s = source?.time_s ?? plan.from_s;
  field ??= new WindField(wind);
  const shared = field;
  if (plan.lookup === "worker" || plan.groups.length === 0) {
    const groups = plan.groups.map((group) => ({ ...group, table: tableOf(group) }));
    const motion = new LocalMotion(groups, shared, plan, time_s);
    const before = source instanceof SharedMotion ? source.local : source;
    if (before instanceof LocalMotion) motion.adopt(before);
    return plan.share ? sharing(motion, plan, shared, socketUrl) : motion;
  }
  const groups = plan.groups.map((group) => {
    const { modeScale, pressure, metadata } = tableOf(group);
    const sampledPeak_pa = sampledPeak(pressure);
    return { ...group, scale: modeScale, height_m: metadata.height_m, sampledPeak_pa };
  });
  const { method, poseEasing, share } = plan;
  const options = { url: socketUrl, method, poseEasing, share, onReply, problem };
  const stream = new StreamMotion(groups, shared, options, time_s);
  const local = plan.groups.map((group) => ({ ...group, table: tableOf(group) }));
  return new FailoverMotion(
    stream,
    (from_s) => new LocalMotion(local, shared, plan, from_s),
    () => blend.start(shown.map((poses, g) => ({ poses, known: everyTree(plan.groups[g]) }))),
  );
}

/** Computes the poses here, with the wind and clock of the shared forest. */
function sharing(local: LocalMotion, plan: ForestPlan, wind: WindField, url: string): SharedMotion {
  const have = Object.fromEntries(plan.groups.map(({ table }) => [table, tableBytes.get(table) ?? 0]));
  const request = () => forestRequest("table", plan.groups, wind, local.time_s, { ...plan, have });
  return new SharedMotion(local, wind, { url, request, onReply, problem });
}

function onReply(reply: Reply): void {
  if (reply.type === "shared") scope.postMessage({ kind: "shared", about: reply.about });
  if (reply.type === "windState")
    scope.postMessage({ kind: "sharedWind", wind: parseState(reply.state).wind });
}

const everyTree = ({ ids }: GroupPlan) => new Uint8Array(ids.length).fill(1);

function setPlan(plan: ForestPlan, wind: WindDocument, socketUrl: string): void {
  const next = makeSource(plan, wind, socketUrl);
  source?.dispose();
  source = next;
  epoch = plan.epoch;
  watched = null;
  const groups = plan.groups.map((group) => ({ ...group, table: tableOf(group) }));
  const carried = groups.map((group) => carryGroup(group, shownGroups, shown));
  blend.start(carried);
  shownGroups = groups;
  shown = groups.map(
    ({ table, ids }, g) =>
      carried[g]?.poses ?? new Float32Array(ids.length * poseStride(table.metadata.modes)),
  );
}

function advance(dt_s: number, buffers: Float32Array<ArrayBuffer>[]): void {
  if (!source || !field) return;
  const begin_ms = performance.now();
  if (source.advance(dt_s, buffers)) blend.apply(buffers, dt_s);
  else for (const [g, buffer] of buffers.entries()) buffer.set(shown[g]); // no new poses yet
  for (const [g, buffer] of buffers.entries()) shown[g].set(buffer);
  const { time_s, connection, coverage, extrapolationRatio } = source;
  const total_ms = performance.now() - begin_ms;
  const wind_ms = source.takeWind_ms();
  const reply: FromWorker = {
    kind: "poses",
    epoch,
    time_s,
    work: { wind_ms, lookup_ms: total_ms - wind_ms, total_ms },
    buffers,
    connection,
    wind: { state: field.state, coverage },
    extrapolationRatio,
    watched: watched && source.inspect(watched),
  };
  scope.postMessage(
    reply,
    buffers.map((buffer) => buffer.buffer),
  );
}

scope.onmessage = ({ data }) => {
  switch (data.kind) {
    case "load":
      void load(data.sha256, data.url);
      break;
    case "plan":
      setPlan(data.plan, data.wind, data.socketUrl);
      advance(0, data.buffers);
      break;
    case "wind":
      field?.change(data.wind, source?.time_s ?? 0);
      source?.windChanged(data.wind);
      break;
    case "pause":
      source?.pause?.(data.paused);
      break;
    case "watch":
      watched = data.at;
      break;
    case "advance":
      if (data.epoch === epoch) advance(data.dt_s, data.buffers);
      break;
  }
};
