/** The worker: decodes tables and keeps the pose of every tree, computed here or received from the server. */

import type { Method } from "../core/motion/method";
import { type PosePacket, packetBuffers, packPoses } from "../core/motion/posePacket";
import { poseStride } from "../core/motion/poseStride";
import type { WindDocument } from "../core/wind/document";
import { WindField } from "../core/wind/field";
import { finalWind, parseState, type WindState } from "../core/wind/transition";
import type { Reply } from "../core/wire/wire";
import { JumpBlend } from "./motion/blend";
import { FailoverMotion } from "./motion/failover";
import { type LocalGroup, LocalMotion } from "./motion/localMotion";
import type { MotionSource } from "./motion/motionSource";
import { PointResponses } from "./motion/pulls/pointResponses";
import { RestRings } from "./motion/pulls/restRings";
import { SharedMotion } from "./motion/sharedMotion";
import { ShownPoses, type StartOfGroup } from "./motion/shownPoses";
import { StreamMotion } from "./motion/streamMotion";
import type { ForestPlan, FromWorker, ShareRequest, ShownTrees, ToWorker, TreeAt } from "./protocol";
import { forestRequest, sharedGroups, streamMethod } from "./stream/forestRequest";
import { forestUrl } from "./stream/forestUrl";
import { motionBuffers, tableMotion } from "./table/tableMotion";
import { TableStore } from "./table/tableStore";

const scope = self as unknown as {
  onmessage: (event: MessageEvent<ToWorker>) => void;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
};

const store = new TableStore();
const blend = new JumpBlend();
let source: MotionSource | null = null;
let field: WindField | null = null;
let epoch = 0;
/** Number of modes of each group of the plan. */
let plannedModes: readonly number[] = [];
/** The shared forest of the plan. */
let sharedForest: ShareRequest | null = null;
/** The displayed poses, which the next plan starts from. */
const shown = new ShownPoses();
let shownMethod: Method = "modal";
let watched: TreeAt | null = null;
let hidden = false;
const responses = new PointResponses(
  { load: (url) => store.loadCompliance(url), get: (url) => store.complianceAt(url) },
  (table, vertex, rest) =>
    scope.postMessage({ kind: "pullField", table, vertex, field: rest }, [rest.buffer]),
);
const rests = new RestRings();

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));
const problem = (title: string, hint: string, code: string | null = null) =>
  scope.postMessage({ kind: "problem", title, hint, code });

async function load(sha256: string, url: string): Promise<void> {
  try {
    const { table, bytes } = await store.load(sha256, url);
    const motion = tableMotion(sha256, table, bytes);
    scope.postMessage({ kind: "table", motion }, motionBuffers(motion));
  } catch (error) {
    scope.postMessage({ kind: "tableFailed", sha256, title: `A table could not be read: ${reason(error)}` });
  }
}

async function loadRecords(table: string, url: string): Promise<void> {
  const fault = await store.loadRecords(table, url).then(() => null, reason);
  scope.postMessage({ kind: "records", table, fault });
}

const localGroups = ({ groups }: ForestPlan): LocalGroup[] =>
  groups.map((group) => ({
    ...group,
    sha256: group.table,
    table: store.table(group.table),
    records: store.recordsOf(group.table),
  }));

/** A wind whose gusts have been made, which takes a tenth of a second. */
function startedField(wind: WindDocument): WindField {
  const started = new WindField(wind);
  const at = () => new Float64Array(1);
  started.velocity(at(), at(), started.at(0), at(), at());
  return started;
}

function makeSource(
  plan: ForestPlan,
  wind: WindDocument | WindState,
  socketUrl: string,
  starts: readonly (StartOfGroup | null)[],
): MotionSource {
  const time_s = source?.time_s ?? plan.from_s;
  field ??= new WindField(wind);
  const shared = field;
  if (plan.lookup === "worker" || plan.groups.length === 0) {
    const motion = new LocalMotion(localGroups(plan), shared, plan, time_s, responses);
    // A pose of the paper's method may be far from the modal one: there the blend alone is smoother.
    if (shownMethod === "modal") motion.startAt(starts);
    const before = source instanceof SharedMotion ? source.local : source;
    if (before instanceof LocalMotion) motion.adopt(before);
    return plan.share ? sharing(motion, plan, shared, socketUrl) : motion;
  }
  const groups = plan.groups.map((group) => {
    const table = store.table(group.table);
    const { height_m, peak_pressure_pa: sampledPeak_pa, streamlined_exponent: streamlined } = table.metadata;
    const pulledTable = { sha256: group.table, table, compliance: group.compliance };
    return { ...group, scale: table.modeScale, height_m, sampledPeak_pa, streamlined, pulledTable };
  });
  const { poseEasing, share } = plan;
  const method = streamMethod(plan.method, plan.groups);
  const options = { url: socketUrl, method, poseEasing, share, responses, onReply, problem };
  const stream = new StreamMotion(groups, shared, options, time_s);
  return new FailoverMotion(
    stream,
    (from_s) => new LocalMotion(localGroups(plan), shared, plan, from_s, responses),
    () => blend.start(shown.all),
  );
}

/** Computes the poses here, with the wind and clock of the shared forest. */
function sharing(local: LocalMotion, plan: ForestPlan, wind: WindField, url: string): SharedMotion {
  const groups = sharedGroups(plan.groups);
  const have = Object.fromEntries(groups.map(({ table }) => [table, store.bytes(table)]));
  const method = streamMethod(plan.method, groups);
  const request = () => forestRequest("table", groups, wind, local.time_s, { ...plan, method, have });
  const placements = plan.groups.map(({ placement }) => placement);
  return new SharedMotion(local, wind, { url, placements, request, onReply, problem });
}

function onReply(reply: Reply): void {
  if (reply.type === "shared") {
    // Whatever replaces these trees later, this page's connection may return without undoing it.
    if (sharedForest) sharedForest.replant = false;
    scope.postMessage({ kind: "shared", about: reply.about });
  }
  if (reply.type === "presence") scope.postMessage({ kind: "present", clients: reply.clients });
  if (reply.type === "windState")
    scope.postMessage({ kind: "sharedWind", wind: finalWind(parseState(reply.state)) });
}

/** Continues what another worker has displayed: trees that were here, too, keep their state all the same. */
function takeOver(trees: readonly ShownTrees[]): void {
  if (trees.length === 0) return;
  shown.show(
    trees.map((group) => ({ ...group, table: store.table(group.table) })),
    trees.map(({ poses }) => poses),
  );
}

function setPlan(plan: ForestPlan, wind: WindDocument | WindState, socketUrl: string): void {
  const starts = shown.continueAs(localGroups(plan));
  const next = makeSource(plan, wind, forestUrl(socketUrl, plan.share), starts);
  source?.dispose();
  source = next;
  if (hidden) source.hide?.(true);
  rests.clear();
  sharedForest = plan.share;
  shownMethod = plan.method;
  epoch = plan.epoch;
  watched = null;
  plannedModes = plan.groups.map((group) => store.table(group.table).metadata.modes);
  blend.start(starts);
}

function advance(dt_s: number, spare: PosePacket | null): void {
  if (!source || !field) return;
  const begin_ms = performance.now();
  shown.begin(dt_s);
  const { buffers } = shown;
  const arrived = source.advance(dt_s, buffers); // otherwise there are no new poses yet
  const changed = (arrived && source.changed) || [];
  if (arrived) blend.apply(buffers, dt_s, changed);
  const groups = plannedModes.map((modes, g) => ({
    poses: buffers[g],
    stride: poseStride(modes),
    modes,
    changed: changed[g] ?? null,
  }));
  const packet = packPoses(groups, spare);
  const { time_s, connection, coverage, extrapolationRatio } = source;
  const total_ms = performance.now() - begin_ms;
  const wind_ms = source.takeWind_ms();
  const reply: FromWorker = {
    kind: "poses",
    epoch,
    time_s,
    work: { wind_ms, lookup_ms: total_ms - wind_ms, total_ms },
    packet,
    connection,
    wind: { state: field.state, coverage },
    extrapolationRatio,
    watched: watched && source.inspect(watched),
    pulled: rests.advance(source.pulled, dt_s),
  };
  scope.postMessage(reply, packetBuffers(packet));
}

scope.onmessage = ({ data }) => {
  switch (data.kind) {
    case "load":
      void load(data.sha256, data.url);
      break;
    case "loadRecords":
      void loadRecords(data.table, data.url);
      break;
    case "plan":
      takeOver(data.shown);
      setPlan(data.plan, data.wind, data.socketUrl);
      advance(0, null);
      break;
    case "wind":
      if (field) field.change(data.wind, source?.time_s ?? 0);
      else field = startedField(data.wind);
      source?.sendWind?.(data.wind);
      break;
    case "pull":
      source?.pull(data.order);
      break;
    case "release":
      source?.release(data.hand);
      break;
    case "gust":
      source?.gust(data.x_m, data.z_m);
      break;
    case "pause":
      source?.pause?.(data.paused);
      break;
    case "retry":
      source?.retry?.();
      break;
    case "hide":
      hidden = data.hidden;
      source?.hide?.(hidden);
      break;
    case "watch":
      watched = data.at;
      source?.watch?.(watched);
      break;
    case "advance":
      source?.see?.(data.viewer);
      if (data.epoch === epoch) advance(data.dt_s, data.spare);
      break;
  }
};
