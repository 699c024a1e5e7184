/** Uploads of trees, chosen with the button or dropped anywhere on the page. */
import { Problem, uploadTree } from "../server/api";
import { element } from "./dom";
import { showToast } from "./toast";
import { displayName } from "./words";

async function send(file: File): Promise<void> {
  try {
    const tree = await uploadTree(file);
    if (tree.state !== "uploaded" && tree.state !== "failed") {
      showToast(
        `${displayName(tree)} is already on the server`,
        "The same file was uploaded before.",
        "good",
      );
      return;
    }
    const { OwnTreeDialog } = await import("../ownTree/dialog");
    if (!(await new OwnTreeDialog(tree).open())) return;
    showToast(
      `Computing ${displayName(tree)}`,
      "It joins the forest with a first, simple motion; the full table follows.",
      "good",
    );
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    showToast(error.title, error.hint);
  }
}

/** Shows the dialogs one after another. */
async function sendInTurn(files: Iterable<File>): Promise<void> {
  for (const file of files) await send(file);
}

/** Accepts uploads until the returned function is called. */
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
    sendAll([...(input.files ?? [])]); // copied, because clearing the input empties the list
    input.value = "";
  };
  input.addEventListener("change", sendChosen, { signal });
  sendChosen(); // files chosen before this script was loaded
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
