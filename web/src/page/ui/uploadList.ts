/** The uploads on the server, in the settings: how each is planted in this forest. */
import type { FolderApi } from "tweakpane";
import type { Planted } from "../settings/planted";

const CHOICES = {
  "Not planted": "none",
  "One in the clearing": "one",
  "Among the others": "more",
  "Only this": "only",
};

export class UploadList {
  private shown = "";

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
    const rows = uploads.map(({ id, name }) => ({ id, name, how: this.planted(id) ?? "none" }));
    const key = JSON.stringify(rows);
    if (key === this.shown) return;
    this.shown = key;
    this.folder.hidden = rows.length === 0;
    for (const child of [...this.folder.children]) this.folder.remove(child);
    for (const { id, name, how } of rows) {
      this.folder
        .addBinding({ how: how as string }, "how", { label: name, options: CHOICES })
        .on("change", ({ value }) => this.plant(id, value === "none" ? null : (value as Planted)));
    }
    this.changed();
  }
}
