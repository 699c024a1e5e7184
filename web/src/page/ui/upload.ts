/** A tree of the visitor's own: by button or dropped anywhere. */
import { Problem, uploadTree } from "../server/api";
import { element } from "./dom";
import { showToast } from "./toast";
import { displayName } from "./words";

async function send(file: File): Promise<void> {
  try {
    const tree = await uploadTree(file);
    if (tree.state !== "uploaded" && tree.state !== "failed") {
      showToast(`${displayName(tree)} is here already`, "It was uploaded before.", "good");
      return;
    }
    const { OwnTreeDialog } = await import("../ownTree/dialog");
    if (!(await new OwnTreeDialog(tree).open())) return;
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

/** One dialog after the other. */
async function sendInTurn(files: Iterable<File>): Promise<void> {
  for (const file of files) await send(file);
}

/** Returns what undoes it. */
export function acceptUploads(): () => void {
  const input = element<HTMLInputElement>("file");
  const curtain = element("drop");
  const life = new AbortController();
  const { signal } = life;
  element("upload").addEventListener("click", () => input.click(), { signal });
  const sendAll = (files: Iterable<File>) => {
    void sendInTurn(files);
  };
  const sendChosen = () => {
    sendAll([...(input.files ?? [])]); // a copy: the list is emptied below
    input.value = "";
  };
  input.addEventListener("change", sendChosen, { signal });
  sendChosen(); // what was chosen before the page's script was here
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
