/** Asks the visitor for the server's key, where it takes uploads only from those who have one. */
import "../ownTree/ownTree.css";
import { make } from "./dom";

const KEPT = "galewood-key";

export const keptKey = (): string | null => sessionStorage.getItem(KEPT);

/** The key that was typed, kept until the tab is closed; null if the visitor has none. */
export function askForKey(): Promise<string | null> {
  const dialog = make("dialog", "", "own-tree");
  const form = make("form");
  const heading = make("h2", "This server wants a key");
  const field = make("input");
  const label = make("label", "", "own-tree-row");
  const foot = make("footer");
  const leave = make("button", "I have none");
  const go = make("button", "Go on", "primary");
  Object.assign(field, { type: "password", autocomplete: "off", required: true });
  heading.id = "key-heading";
  dialog.setAttribute("aria-labelledby", heading.id);
  form.method = "dialog";
  leave.type = "button";
  leave.addEventListener("click", () => dialog.close());
  label.append(
    make("span", "Key"),
    field,
    make("small", "Ask whoever runs it. It is kept until you close this tab."),
  );
  foot.append(leave, go);
  form.append(heading, label, foot);
  dialog.append(form);
  document.body.append(dialog);
  return new Promise((resolve) => {
    let key: string | null = null;
    form.addEventListener("submit", () => {
      key = field.value.trim();
      sessionStorage.setItem(KEPT, key);
    });
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(key);
    });
    dialog.showModal();
  });
}
