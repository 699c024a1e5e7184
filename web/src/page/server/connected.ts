/** What needs the server, while it may be gone: the one place that says so, and that does it again when it is back. */
import { showToast } from "../ui/toast";
import { Disconnected, Problem } from "./api";

const AGAIN_MS = 600;

const pause = (time_ms: number) => new Promise((done) => setTimeout(done, time_ms));

/**
 * Loads a part of the page that is fetched when it is first needed, and once more if that fails. Rejects with
 * `Disconnected`. Style sheets of such parts belong to a part that is loaded at the start: Vite does not fetch one again.
 */
export async function loadPart<T>(load: () => Promise<T>): Promise<T> {
  try {
    return await load();
  } catch {
    await pause(AGAIN_MS);
    return await load().catch(() => {
      throw new Disconnected();
    });
  }
}

/**
 * Does work of the visitor that needs the server. Without the server it says that this is `undone` and offers to try again,
 * with all that `work` holds; other problems are shown. Returns whether it is done.
 */
export async function withServer(undone: string, work: () => Promise<unknown>): Promise<boolean> {
  try {
    await work();
    return true;
  } catch (error) {
    if (error instanceof Disconnected) {
      showToast(error.title, `${undone} ${error.hint}`, "bad", () => void withServer(undone, work));
    } else if (error instanceof Problem) showToast(error.title, error.hint);
    else throw error;
    return false;
  }
}
