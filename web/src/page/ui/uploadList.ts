/** The uploads on the server, in the settings: how each is planted in this forest. */
import type { FolderApi } from "tweakpane";
import type { Planted } from "../settings/planted";

const CHOICES = {
  "Not planted": "none",
  "One in the clearing": "one",
  "Among the others": "more",
  "Only this": "only",
};

interface Row {
  readonly id: string;
  how: string;
}

export class UploadList {
  private names = "";
  private rows: Row[] = [];
  /** True while choices made elsewhere are shown: Tweakpane reports them as changes. */
  private refreshing = false;

  /** `planted` says how an upload is planted, null if it is not; `plant` changes it. */
  constructor(
    private readonly folder: FolderApi,
    private readonly planted: (id: string) => Planted | null,
    private readonly plant: (id: string, how: Planted | null) => void,
    private readonly changed: () => void,
  ) {
    folder.hidden = true;
  }

  show(uploads: readonly { id: string; name: string }[]): void {
    const names = JSON.stringify(uploads);
    if (names !== this.names) this.rebuild(uploads);
    else if (this.rows.some(({ id, how }) => how !== this.how(id))) this.refresh();
    this.names = names;
  }

  private how(id: string): string {
    return this.planted(id) ?? "none";
  }

  private rebuild(uploads: readonly { id: string; name: string }[]): void {
    this.folder.hidden = uploads.length === 0;
    for (const child of [...this.folder.children]) this.folder.remove(child);
    this.rows = uploads.map(({ id, name }) => {
      const row = { id, how: this.how(id) };
      this.folder.addBinding(row, "how", { label: name, options: CHOICES }).on("change", ({ value }) => {
        if (!this.refreshing) this.plant(id, value === "none" ? null : (value as Planted));
      });
      return row;
    });
    this.changed();
  }

  private refresh(): void {
    for (const row of this.rows) row.how = this.how(row.id);
    this.refreshing = true;
    this.folder.refresh();
    this.refreshing = false;
  }
}
