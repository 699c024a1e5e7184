/**
 * The order in which the trees of a forest load: first the one that is seen in the middle of the first picture, alone, then all others.
 * Where the processor draws as well, the others would delay it by seconds.
 */
import type { TreeAsset } from "../../scene/forest";

/** The server lists all its trees within this time of the first one. */
const LISTED_WITHIN_MS = 40;
/** Trees that wait for the first one wait no longer than this. */
const WAIT_FOR_FIRST_MS = 4000;

export class LoadingOrder {
  /** Settled when the first tree may load. */
  readonly firstLoads: Promise<void>;
  /** Settled when the first mesh is there, and is being opened. */
  readonly firstArrives: Promise<void>;
  private readonly othersLoad: Promise<void>;
  private settleFirst: () => void = () => undefined;
  private settleOthers: () => void = () => undefined;
  private settleArrival: () => void = () => undefined;
  private first: TreeAsset | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private waits = true;

  /** `choose`: the first tree, once those of the server are known. */
  constructor(private readonly choose: () => TreeAsset | null) {
    this.firstLoads = new Promise((done) => {
      this.settleFirst = done;
    });
    this.firstArrives = new Promise((done) => {
      this.settleArrival = done;
    });
    this.othersLoad = new Promise((done) => {
      this.settleOthers = done;
    });
  }

  /** Whether the trees after the first one wait for it. */
  get awaitsFirst(): boolean {
    return this.waits;
  }

  /** Settled when a tree may load that the server has just listed. */
  async turnOf(asset: TreeAsset): Promise<void> {
    this.timer ??= setTimeout(() => this.begin(), LISTED_WITHIN_MS);
    await this.firstLoads;
    if (asset !== this.first) await this.othersLoad;
  }

  private begin(): void {
    this.first = this.choose();
    this.settleFirst();
    this.timer = setTimeout(() => this.loadAll(), WAIT_FOR_FIRST_MS);
  }

  /** To be called with every mesh that arrives. */
  meshArrived(): void {
    this.settleArrival();
  }

  /** Lets all trees load. */
  loadAll(): void {
    clearTimeout(this.timer);
    this.waits = false;
    this.settleFirst();
    this.settleOthers();
  }
}
