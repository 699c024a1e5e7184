/** Links to this forest: copies them, shares the forest with others, shows who is here, and the code that embeds it. */

import { tool } from "../controls/tools";
import type { World } from "../forest/world";
import { canBeShared } from "../inventory/inventoryPlanting";
import { findService } from "../server/api";
import { withServer } from "../server/connected";
import { type Moment, shareQuery } from "../settings/link";
import { withShared } from "../settings/sharedForest";
import type { Store } from "../store/store";
import { showToast } from "../ui/toast";
import { embedCode } from "./embedCode";
import { showEmbedCode } from "./embedDialog";
import { makeSharingCard } from "./sharingCard";

const ID_LETTERS = "abcdefghijkmnpqrstuvwxyz23456789";
const ID_LENGTH = 12;

/** An id that nobody guesses. */
function newId(): string {
  const random = crypto.getRandomValues(new Uint8Array(ID_LENGTH));
  return Array.from(random, (byte) => ID_LETTERS[byte % ID_LETTERS.length]).join("");
}

async function copy(text: string, title: string, hint: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    showToast(title, hint, "good");
  } catch {
    showToast("Copy it from the address bar", "The browser blocked access to the clipboard.", "good");
  }
}

export class Sharing {
  readonly tools = [
    tool("share", "Share this forest", () => void this.share()),
    tool("link", "Copy link", () => {
      history.replaceState(null, "", this.link);
      void copy(this.link, "Link copied", "It restores this forest, wind, light and view.");
    }),
    tool("embed", "Embed code", () => this.embed()),
  ];

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    makeSharingCard(
      store.state,
      () => this.copyShared(),
      () => this.embed(),
    );
  }

  /** What is seen now. */
  get moment(): Moment {
    const { camera, controls, sky } = this.world.stage;
    return {
      eye: camera.position.toArray(),
      target: controls.target.toArray(),
      time_s: this.world.client.time_s,
      clouds: sky.drift.toArray(),
    };
  }

  /** A link to this forest and view. */
  get link(): string {
    const { settings, state } = this.store;
    const query = withShared(shareQuery(settings, this.moment), state.share);
    return `${location.origin}${location.pathname}?${query}`;
  }

  /** Shares the forest if it is private, and copies its link. */
  private async share(): Promise<void> {
    const { state } = this.store;
    if (state.share === null && !canBeShared(this.store)) return;
    await withServer("This forest is not shared.", async () => {
      await findService();
      state.share ??= newId();
      this.copyShared();
    });
  }

  private embed(): void {
    showEmbedCode(embedCode(this.link), (code) =>
      copy(code, "Embed code copied", "Paste it into the HTML of a page."),
    );
  }

  private copyShared(): void {
    const hint = "Everyone with it sees the same trees in the same wind, and may change both.";
    void copy(this.link, "Link to this shared forest copied", hint);
  }
}
