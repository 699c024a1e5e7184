/** The worker: decodes tables, and keeps every tree's pose, looked up here or received from the server. */
import { decodeTable, type Table } from "../table";
import { sampledPeak, type WindDocument, WindField } from "../wind";
import { JumpBlend } from "./blend";
import { LocalMotion } from "./localMotion";
import type { MotionSource } from "./motion";
import type { ForestPlan, FromWorker, GroupPlan, ToWorker } from "./protocol";
import { StreamMotion } from "./streamMotion";
import { tableMotion } from "./tableMotion";

const scope = self as unknown as {
  onmessage: (event: MessageEvent<ToWorker>) => void;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
};

const tables = new Map<string, Table>();
const blend = new JumpBlend();
let source: MotionSource | null = null;
let field: WindField | null = null;
let epoch = 0;
/** What the screen shows, to fade from when the source changes. */
let shown: Float32Array[] = [];

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));
const problem = (title: string, hint: string) => scope.postMessage({ kind: "problem", title, hint });

async function load(sha256: string, url: string): Promise<void> {
  try {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`the server answered ${response.status}`);
    const bytes = await response.arrayBuffer();
    const table = decodeTable(bytes);
    tables.set(sha256, table);
    const motion = tableMotion(sha256, table, bytes.byteLength);
    const transfer = [motion.basis.buffer, motion.vertexNode.buffer, motion.crownBasis.buffer];
    scope.postMessage({ kind: "table", motion }, transfer);
  } catch (error) {
    scope.postMessage({ kind: "tableFailed", sha256, title: `A table could not be read: ${reason(error)}` });
  }
}

function tableOf({ table }: GroupPlan): Table {
  const found = tables.get(table);
  if (!found) throw new Error(`table ${table} was planned before it was loaded`);
  return found;
}

function makeSource(plan: ForestPlan, wind: WindDocument, socketUrl: string): MotionSource {
  const time_s = source?.time_s ?? 0;
  field ??= new WindField(wind);
  if (plan.lookup === "worker" || plan.groups.length === 0) {
    const groups = plan.groups.map((group) => ({ table: tableOf(group), placement: group.placement }));
    return new LocalMotion(groups, field, plan, time_s);
  }
  const groups = plan.groups.map((group) => {
    const { modeScale, pressure, metadata } = tableOf(group);
    const sampledPeak_pa = sampledPeak(pressure);
    return { ...group, scale: modeScale, height_m: metadata.height_m, sampledPeak_pa };
  });
  const options = { url: socketUrl, method: plan.method, poseEasing: plan.poseEasing, problem };
  return new StreamMotion(groups, field, options, time_s);
}

function setPlan(plan: ForestPlan, wind: WindDocument, socketUrl: string): void {
  const next = makeSource(plan, wind, socketUrl);
  source?.dispose();
  source = next;
  epoch = plan.epoch;
  blend.start(shown);
}

function advance(dt_s: number, buffers: Float32Array<ArrayBuffer>[]): void {
  if (!source || !field) return;
  const begin_ms = performance.now();
  if (source.advance(dt_s, buffers)) blend.apply(buffers, dt_s);
  else hold(buffers);
  remember(buffers);
  const { time_s, connection, coverage } = source;
  const work_ms = performance.now() - begin_ms;
  const transfer = buffers.map((buffer) => buffer.buffer);
  const wind = { state: field.state, coverage };
  scope.postMessage({ kind: "poses", epoch, time_s, work_ms, buffers, connection, wind }, transfer);
}

const fits = (buffers: readonly Float32Array[]) =>
  shown.length === buffers.length && buffers.every((buffer, g) => buffer.length === shown[g].length);

/** Nothing new is known: the trees keep the pose they have. */
function hold(buffers: readonly Float32Array[]): void {
  if (!fits(buffers)) return;
  for (const [g, buffer] of buffers.entries()) buffer.set(shown[g]);
}

function remember(buffers: readonly Float32Array[]): void {
  if (!fits(buffers)) shown = buffers.map((buffer) => buffer.slice());
  else for (const [g, buffer] of buffers.entries()) shown[g].set(buffer);
}

scope.onmessage = ({ data }) => {
  switch (data.kind) {
    case "load":
      void load(data.sha256, data.url);
      break;
    case "plan":
      setPlan(data.plan, data.wind, data.socketUrl);
      break;
    case "wind":
      field?.change(data.wind, source?.time_s ?? 0);
      source?.windChanged(data.wind);
      break;
    case "advance":
      if (data.epoch === epoch) advance(data.dt_s, data.buffers);
      break;
  }
};
