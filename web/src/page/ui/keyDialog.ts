/** Asks the visitor for an access key if the server requires one for uploads. */
import "../ownTree/ownTree.css";
import { make } from "./dom";

const STORAGE_KEY = "galewood-key";

export const keptKey = (): string | null => sessionStorage.getItem(STORAGE_KEY);

/** Resolves with the entered key, which is kept until the tab is closed, or with null if the dialog is cancelled. */
export function askForKey(): Promise<string | null> {
  const dialog = make("dialog", "", "own-tree");
  const form = make("form");
  const heading = make("h2", "Access key required");
  const field = make("input");
  const label = make("label", "", "own-tree-row");
  const foot = make("footer");
  const leave = make("button", "Cancel");
  const go = make("button", "Continue", "primary");
  Object.assign(field, { type: "password", autocomplete: "off", required: true });
  heading.id = "key-heading";
  dialog.setAttribute("aria-labelledby", heading.id);
  form.method = "dialog";
  leave.type = "button";
  leave.addEventListener("click", () => dialog.close());
  label.append(
    make("span", "Access key"),
    field,
    make("small", "The operator of this server can give you a key. It is kept until you close this tab."),
  );
  foot.append(leave, go);
  form.append(heading, label, foot);
  dialog.append(form);
  document.body.append(dialog);
  return new Promise((resolve) => {
    let key: string | null = null;
    form.addEventListener("submit", () => {
      key = field.value.trim();
      sessionStorage.setItem(STORAGE_KEY, key);
    });
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(key);
    });
    dialog.showModal();
  });
}
