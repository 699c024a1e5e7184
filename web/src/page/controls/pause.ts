/** Pausing: a button, the space bar, and the wish of the visitor's system for little motion. */
import type { Playback } from "../store/playback";
import { element, prefersCalm } from "../ui/dom";
import { showToast } from "../ui/toast";
import { toggle } from "./tools";

export function connectPause(playback: Playback): void {
  const flip = () => {
    playback.paused = !playback.paused;
  };
  const button = toggle("pause", "Pause the motion (Space)", () => playback.paused, flip);
  element("playback").replaceChildren(button);
  addEventListener("keydown", (event) => {
    // unless a control has the focus
    const free = event.target === document.body || event.target instanceof HTMLCanvasElement;
    if (event.key !== " " || !free || event.repeat) return;
    event.preventDefault();
    flip();
  });
  if (!prefersCalm()) return;
  playback.paused = true;
  showToast(
    "The motion is paused.",
    "Your system asks for reduced motion. Press the pause button or Space to let the trees sway.",
    "good",
  );
}
