/** Shows a file on its way to the server, with the remaining time; closing the dialog ends the upload. */
import { ProgressBar } from "../progress/progressBar";
import { type ReportedTree, uploadTree } from "../server/api";
import { make, makeButton } from "../ui/dom";
import { timeLeft } from "../ui/words";

/** Short uploads need no dialog. */
const PATIENCE_MS = 400;
/** Estimates before this are too rough. */
const FIRST_ESTIMATE_S = 1;

/** What is said of an upload of which a share was sent in this time. Pure. */
export function sendingWords(share: number, spent_s: number): string {
  if (share >= 1) return "Reading the mesh on the server";
  if (share <= 0 || spent_s < FIRST_ESTIMATE_S) return "Sending the file";
  return `Sending the file, ${timeLeft((spent_s * (1 - share)) / share)}`;
}

/** Uploads a file; null if the visitor ended it. Throws a Problem. */
export async function sendFile(file: File): Promise<ReportedTree | null> {
  const life = new AbortController();
  const bar = new ProgressBar(`Sending ${file.name}`);
  const line = make("p", "Sending the file", "own-tree-message");
  line.setAttribute("role", "status");
  const dialog = dialogFor(file.name, bar, line);
  dialog.addEventListener("close", () => life.abort());
  const timer = setTimeout(() => dialog.showModal(), PATIENCE_MS);
  const began_ms = performance.now();
  const progress = (share: number) => {
    bar.show(share);
    line.textContent = sendingWords(share, (performance.now() - began_ms) / 1000);
  };
  try {
    return await uploadTree(file, { signal: life.signal, progress });
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") return null;
    throw error;
  } finally {
    clearTimeout(timer);
    dialog.remove();
  }
}

function dialogFor(name: string, bar: ProgressBar, line: HTMLElement): HTMLDialogElement {
  const dialog = make("dialog", "", "own-tree sending");
  const title = make("h2", name);
  title.id = "sending-heading";
  dialog.setAttribute("aria-labelledby", title.id);
  const foot = make("footer");
  foot.append(makeButton("Cancel", () => dialog.close()));
  dialog.append(title, bar.root, line, foot);
  document.body.append(dialog);
  return dialog;
}
