/** Has trees read by a worker; where there is none, or it ends, the page reads them itself. */
import { answer, type ReadOrder, type ReadReply } from "./reading";
import type { ReadTree, TreeKind, TreeMesh } from "./treeArrays";

interface Waiting {
  readonly order: ReadOrder;
  take(reply: ReadReply): void;
}

export class TreeReader {
  private readonly waiting = new Map<number, Waiting>();
  private asked = 0;
  /** null: not started. */
  private worker: Worker | "none" | null = null;

  constructor(private readonly startWorker: () => Worker) {}

  /** Starts the worker, so that it is there for the first tree. */
  start(): void {
    if (this.worker) return;
    if (typeof Worker === "undefined") {
      this.worker = "none";
      return;
    }
    this.worker = this.startWorker();
    this.worker.onmessage = ({ data }: MessageEvent<ReadReply>) => this.receive(data);
    this.worker.onerror = () => this.readHere();
  }

  /** Reads the meshes of a tree; rejects if they cannot be read. */
  read(meshes: readonly TreeMesh[], kind: TreeKind): Promise<ReadTree> {
    this.start();
    return new Promise((resolve, reject) => {
      const order = { number: this.asked++, meshes, kind };
      const take = (reply: ReadReply) => (reply.tree ? resolve(reply.tree) : reject(new Error(reply.fault)));
      this.waiting.set(order.number, { order, take });
      const { worker } = this;
      if (worker && worker !== "none") worker.postMessage(order);
      else this.receive(answer(order));
    });
  }

  private receive(reply: ReadReply): void {
    this.waiting.get(reply.number)?.take(reply);
    this.waiting.delete(reply.number);
  }

  /** The worker has ended, or cannot be started here. */
  private readHere(): void {
    this.worker = "none";
    for (const { order } of [...this.waiting.values()]) this.receive(answer(order));
  }
}

/** That of the page. */
export const treeReader = new TreeReader(
  () => new Worker(new URL("./trees.worker.ts", import.meta.url), { type: "module" }),
);
