/** Buttons of the toolbar: an icon with a short name, in the menu of a narrow page with all its words. */
import { effect } from "@preact/signals-core";
import { make, makeButton } from "../ui/dom";
import { type IconName, icon } from "./icons";

/** What stands below each icon of the toolbar. */
const SHORT_WORDS: Record<IconName, string> = {
  pause: "Pause",
  views: "Views",
  fly: "Fly",
  link: "Link",
  photo: "Photo",
  film: "Video",
  full: "Full screen",
  trees: "Physics",
  compare: "Accuracy",
  undo: "Undo",
  redo: "Redo",
  share: "Share",
  embed: "Embed",
  sound: "Sound",
};

export function tool(name: IconName, words: string, pressed: () => void): HTMLButtonElement {
  const made = makeButton("", pressed, "tool");
  made.title = words;
  made.setAttribute("aria-label", words);
  made.append(icon(name), make("span", words, "words"), make("span", SHORT_WORDS[name], "short"));
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
