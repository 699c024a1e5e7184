/** Undo and redo: a list of states, each a text. Pure. */

/** Changes of the same kind in quick succession, as while a slider is dragged, are one step. */
const MERGED_MS = 900;
const MOST_STEPS = 100;

export class History {
  private readonly past: string[] = [];
  private future: string[] = [];
  private kind = "";
  private last_ms = Number.NEGATIVE_INFINITY;

  constructor(private present: string) {}

  /** Notes the state after a change of some kind. */
  record(state: string, kind: string, now_ms: number): void {
    if (state === this.present) return;
    const goesOn = kind === this.kind && now_ms - this.last_ms < MERGED_MS;
    if (!goesOn) this.past.push(this.present);
    if (this.past.length > MOST_STEPS) this.past.shift();
    this.present = state;
    this.future = [];
    this.kind = kind;
    this.last_ms = now_ms;
  }

  /** Notes a state that someone else made, which is not undone here. */
  adopt(state: string): void {
    this.present = state;
    this.kind = "";
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** The state before the last change; null if there is none. */
  undo(): string | null {
    return this.move(this.past, this.future);
  }

  /** The state that was undone last; null if there is none. */
  redo(): string | null {
    return this.move(this.future, this.past);
  }

  private move(from: string[], to: string[]): string | null {
    const state = from.pop();
    if (state === undefined) return null;
    to.push(this.present);
    this.present = state;
    this.kind = "";
    return state;
  }
}
