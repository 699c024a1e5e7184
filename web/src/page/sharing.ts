/** Shares the forest: makes its link, shows who is here, and the code that embeds it. */
import { embedCode } from "./settings/embedCode";
import { showEmbedCode } from "./ui/embedDialog";
import { SharingCard } from "./ui/sharingCard";
import { showToast } from "./ui/toast";

export interface SharingPage {
  /** Id of the shared forest; null while the forest is private. */
  readonly share: string | null;
  /** Makes the forest a shared one with this id; returns whether it can be one. */
  start(id: string): boolean;
  /** A link to this forest and view. */
  link(): string;
}

const LETTERS = "abcdefghijkmnpqrstuvwxyz23456789";
const LENGTH = 12;

/** An id that nobody guesses. */
function newId(): string {
  const random = crypto.getRandomValues(new Uint8Array(LENGTH));
  return Array.from(random, (byte) => LETTERS[byte % LETTERS.length]).join("");
}

export async function copy(text: string, title: string, hint: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    showToast(title, hint, "good");
  } catch {
    showToast("Copy it from the address bar", "The browser blocked access to the clipboard.", "good");
  }
}

export class Sharing {
  private readonly card: SharingCard;

  constructor(private readonly page: SharingPage) {
    this.card = new SharingCard({ copyLink: () => void this.copyLink(), embed: () => this.embed() });
    if (page.share !== null) this.card.show(null);
  }

  /** Shares the forest if it is private, and copies its link. */
  share(): void {
    if (this.page.share === null) {
      if (!this.page.start(newId())) return;
      this.card.show(null);
    }
    void this.copyLink();
  }

  present(clients: number): void {
    if (this.page.share !== null) this.card.show(clients);
  }

  embed(): void {
    showEmbedCode(embedCode(this.page.link()), (code) =>
      copy(code, "Embed code copied", "Paste it into the HTML of a page."),
    );
  }

  private copyLink(): Promise<void> {
    const hint = "Everyone with it sees the same trees in the same wind, and may change both.";
    return copy(this.page.link(), "Link to this shared forest copied", hint);
  }

  dispose(): void {
    this.card.dispose();
  }
}
