/** A tree of the visitor's own: by button or dropped anywhere. */
import { Problem, startPrecompute, uploadTree } from "../api";
import { element } from "./dom";
import { showToast } from "./toast";
import { displayName } from "./words";

async function send(file: File): Promise<void> {
  try {
    const tree = await uploadTree(file);
    await startPrecompute(tree.id);
    showToast(
      `${displayName(tree)} is on its way`,
      "It joins the forest once its motion is computed.",
      "good",
    );
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    showToast(error.title, error.hint);
  }
}

/** Returns what undoes it. */
export function acceptUploads(): () => void {
  const input = element<HTMLInputElement>("file");
  const curtain = element("drop");
  const life = new AbortController();
  const { signal } = life;
  element("upload").addEventListener("click", () => input.click(), { signal });
  const sendAll = (files: Iterable<File>) => {
    for (const file of files) void send(file);
  };
  input.addEventListener(
    "change",
    () => {
      sendAll([...(input.files ?? [])]);
      input.value = "";
    },
    { signal },
  );
  addEventListener(
    "dragover",
    (event) => {
      event.preventDefault();
      curtain.hidden = false;
    },
    { signal },
  );
  addEventListener(
    "dragleave",
    (event) => {
      if (event.relatedTarget === null) curtain.hidden = true;
    },
    { signal },
  );
  addEventListener(
    "drop",
    (event) => {
      event.preventDefault();
      curtain.hidden = true;
      sendAll([...(event.dataTransfer?.files ?? [])]);
    },
    { signal },
  );
  return () => life.abort();
}
