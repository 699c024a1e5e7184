/** Answers the messages of a forest, whoever computes its poses. */

import type { Viewer } from "../../core/motion/simulationLevels";
import { faultOf, fileBytes } from "../../core/net/fileBytes";
import { drawnBuffers } from "../../core/table/drawnMotion";
import type { DrawnMotion } from "../../core/table/drawnTable";
import type { WindDocument } from "../../core/wind/document";
import type { Floats, FromWorker, GroupFrame, ToWorker } from "./messages";

/** What computes poses. */
export interface PoseMaker {
  readonly time_s: number;
  read(table: number, bytes: ArrayBuffer, from: string): DrawnMotion;
  plant(group: number, table: number, placement: Floats): void;
  remove(group: number): void;
  setWind(wind: WindDocument | null): void;
  advance(dt_s: number, viewer: Viewer, frames: readonly GroupFrame[]): void;
}

type Post = (message: FromWorker, transfer: Transferable[]) => void;

async function load(maker: PoseMaker, table: number, from: string | ArrayBuffer, post: Post): Promise<void> {
  try {
    const bytes = typeof from === "string" ? await fileBytes(from, fetch(from)) : from;
    const motion = maker.read(table, bytes, `${from}`);
    post({ kind: "table", table, motion }, drawnBuffers(motion));
  } catch (error) {
    post({ kind: "failed", table, fault: faultOf(from, error) }, []);
  }
}

export function answer(maker: PoseMaker, data: ToWorker, post: Post): void {
  if (data.kind === "load") void load(maker, data.table, data.from, post);
  else if (data.kind === "plant") maker.plant(data.group, data.table, data.placement);
  else if (data.kind === "remove") maker.remove(data.group);
  else if (data.kind === "wind") maker.setWind(data.wind);
  else {
    const { dt_s, viewer, frames } = data;
    maker.advance(dt_s, viewer, frames);
    const buffers = frames.flatMap(({ poses, velocity }) =>
      velocity ? [poses.buffer, velocity.buffer] : [poses.buffer],
    );
    post({ kind: "poses", time_s: maker.time_s, frames }, buffers);
  }
}
