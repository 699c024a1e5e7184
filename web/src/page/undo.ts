/** Undo and redo of wind and settings, by button and keyboard. */
import { History } from "./settings/history";
import type { Settings } from "./settings/settings";

export interface UndoEvents {
  /** These settings have been replaced. */
  replaced(keys: (keyof Settings)[]): void;
  /** What is possible now. */
  possible(undo: boolean, redo: boolean): void;
}

/** Whether a key press belongs to a text field, which has its own undo. */
const typing = (target: EventTarget | null) =>
  target instanceof HTMLTextAreaElement ||
  (target instanceof HTMLInputElement && /^(text|number|search|url|password)$/.test(target.type));

export class Undo {
  private readonly history: History;
  private readonly life = new AbortController();

  constructor(
    private readonly settings: Settings,
    private readonly events: UndoEvents,
  ) {
    this.history = new History(this.state);
    addEventListener("keydown", (event) => this.key(event), { signal: this.life.signal });
  }

  private get state(): string {
    return JSON.stringify(this.settings);
  }

  private key(event: KeyboardEvent): void {
    const { key, shiftKey } = event;
    if (!(event.ctrlKey || event.metaKey) || event.altKey || typing(event.target)) return;
    const letter = key.toLowerCase();
    if (letter !== "z" && letter !== "y") return;
    event.preventDefault();
    if (letter === "y" || shiftKey) this.redo();
    else this.undo();
  }

  /** Call after every change that the visitor made; `kind` names what was changed. */
  record(kind: string): void {
    this.history.record(this.state, kind, performance.now());
    this.tell();
  }

  /** Call after a change that others made. */
  adopt(): void {
    this.history.adopt(this.state);
  }

  undo(): void {
    this.replace(this.history.undo());
  }

  redo(): void {
    this.replace(this.history.redo());
  }

  private replace(state: string | null): void {
    if (state === null) return;
    const then = JSON.parse(state) as Settings;
    const keys = (Object.keys(then) as (keyof Settings)[]).filter(
      (key) => JSON.stringify(then[key]) !== JSON.stringify(this.settings[key]),
    );
    for (const key of keys) Object.assign(this.settings, { [key]: then[key] });
    this.events.replaced(keys);
    this.tell();
  }

  private tell(): void {
    this.events.possible(this.history.canUndo, this.history.canRedo);
  }

  dispose(): void {
    this.life.abort();
  }
}
