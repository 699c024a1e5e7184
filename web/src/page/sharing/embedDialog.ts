/** Shows the code that embeds the forest in another page. */
import { make, makeButton } from "../ui/dom";

const EMBED_TEXT =
  "Paste this into a page. It shows the forest as it is now, with a pause button and a link. The server decides which " +
  "sites may embed it (GALEWOOD_FRAME_ANCESTORS).";

export function showEmbedCode(code: string, copy: (text: string) => Promise<void>): void {
  const dialog = make("dialog", "", "physics embed-dialog");
  const heading = make("h2", "Embed");
  heading.id = "embed-heading";
  dialog.setAttribute("aria-labelledby", heading.id);
  const text = make("textarea", code);
  text.readOnly = true;
  text.rows = 6;
  text.setAttribute("aria-label", "Embed code");
  const copyButton = makeButton("Copy", () => {
    text.select();
    void copy(code);
  });
  const close = makeButton("Close", () => dialog.close());
  dialog.addEventListener("close", () => dialog.remove());
  const head = make("header");
  head.append(heading, copyButton, close);
  dialog.append(head, make("p", EMBED_TEXT), text);
  document.body.append(dialog);
  dialog.showModal();
}
