/** Uploads of trees, chosen with the button or dropped anywhere on the page. */
import "../ownTree/ownTree.css";
import "../ownTree/painting/painting.css";
import "../ownTree/severalTrees.css";
import type { DataFiles } from "../files/dataFiles";
import type { ReportedTree } from "../server/api";
import { loadPart, withServer } from "../server/connected";
import { element } from "../ui/dom";
import { showToast } from "../ui/toast";
import { displayName } from "../ui/words";
import { type Chosen, chosenFiles, droppedFiles, grouped, uploadOf } from "./fileGroups";
import type { OwnUploads } from "./ownUploads";
import { sendFile } from "./sendingDialog";

/** Sends the files of a tree. They are kept until they have arrived. */
async function send(group: readonly Chosen[], uploads: OwnUploads): Promise<void> {
  const names = group.map(({ file }) => file.name).join(", ");
  let tree: ReportedTree | null = null;
  await withServer(`${names} was not uploaded; the page keeps it.`, async () => {
    tree ??= await sendFile(await uploadOf(group));
    if (!tree) return;
    if (tree.state !== "uploaded" && tree.state !== "failed") {
      uploads.add(tree.id, false);
      showToast(
        `${displayName(tree)} is already on the server`,
        "The same file was uploaded before. One such tree is planted in the clearing of your forest.",
        "good",
      );
      return;
    }
    const { OwnTreeDialog } = await loadPart(() => import("../ownTree/dialog"));
    await new OwnTreeDialog(tree, uploads).open();
  });
}

/** Shows the dialogs one after another. Textures and buffers are sent with their mesh. */
async function sendInTurn(files: readonly Chosen[], uploads: OwnUploads, data: DataFiles): Promise<void> {
  const trees: Chosen[] = [];
  for (const one of files) if (!(await data.take(one.file))) trees.push(one);
  for (const group of grouped(trees)) await send(group, uploads);
}

export function acceptUploads(uploads: OwnUploads, data: DataFiles): void {
  const input = element<HTMLInputElement>("file");
  const curtain = element("drop");
  element("upload").addEventListener("click", () => input.click());
  const sendAll = (files: readonly Chosen[]) => {
    void sendInTurn(files, uploads, data);
  };
  const sendChosen = () => {
    sendAll(chosenFiles(input.files ?? [])); // copied, because clearing the input empties the list
    input.value = "";
  };
  input.addEventListener("change", sendChosen);
  sendChosen(); // files chosen before this script was loaded
  addEventListener("dragover", (event) => {
    event.preventDefault();
    curtain.hidden = false;
  });
  addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) curtain.hidden = true;
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    curtain.hidden = true;
    if (event.dataTransfer) void droppedFiles(event.dataTransfer).then(sendAll);
  });
}
