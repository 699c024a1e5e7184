/** The only controls of an embedded forest: pause, and a link to the whole page. */
import { effect } from "@preact/signals-core";
import type { Playback } from "../store/playback";
import { element, make, makeButton } from "../ui/dom";

/** The address of the whole page, given that of an embedded one. */
function withoutEmbed(link: string): string {
  const url = new URL(link);
  for (const name of ["embed", "panel"]) url.searchParams.delete(name);
  return url.href;
}

/** `link` gives the address of the forest as it is now. */
export function showEmbedBar(playback: Playback, link: () => string): void {
  const bar = element("embed");
  bar.hidden = false;
  const pause = makeButton("", () => {
    playback.paused = !playback.paused;
  });
  effect(() => {
    pause.textContent = playback.paused ? "Play" : "Pause";
    pause.setAttribute("aria-label", playback.paused ? "Resume the motion" : "Pause the motion");
  });
  const whole = make("a", "Galewood ↗");
  whole.target = "_blank";
  whole.rel = "noopener";
  whole.href = withoutEmbed(link());
  whole.addEventListener("pointerdown", () => {
    whole.href = withoutEmbed(link()); // as the forest is now
  });
  bar.replaceChildren(pause, whole);
}
