/** Buttons of the toolbar: an icon, and words for screen readers and the menu of a phone. */
import { effect } from "@preact/signals-core";
import { make, makeButton } from "../ui/dom";
import { type IconName, icon } from "./icons";

export function tool(name: IconName, words: string, pressed: () => void): HTMLButtonElement {
  const made = makeButton("", pressed, "tool");
  made.title = words;
  made.setAttribute("aria-label", words);
  made.append(icon(name), make("span", words));
  return made;
}

/** A button that is pressed or not; `isOn` is read in an effect. */
export function toggle(
  name: IconName,
  words: string,
  isOn: () => boolean,
  pressed: () => void,
): HTMLButtonElement {
  const made = tool(name, words, pressed);
  effect(() => made.setAttribute("aria-pressed", String(isOn())));
  return made;
}

/** Full screen; hidden where the browser does not allow it. */
export function fullScreenTool(): HTMLButtonElement {
  const made = tool("full", "Full screen", () => {
    void (document.fullscreenElement
      ? document.exitFullscreen()
      : document.documentElement.requestFullscreen());
  });
  made.hidden = !document.fullscreenEnabled;
  return made;
}
