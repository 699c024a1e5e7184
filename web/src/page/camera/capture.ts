/** Photos and short videos of the canvas, saved as files. */

import { toggle, tool } from "../controls/tools";
import type { World } from "../forest/world";
import type { Store } from "../store/store";
import { saveFile } from "../ui/saveFile";
import { showToast } from "../ui/toast";

const FILM_FPS = 30;
const LONGEST_FILM_S = 20;
const FILM_BITS_PER_S = 8_000_000;
const VIDEO_TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

const stamp = () => new Date().toISOString().slice(0, 19).replace(/[:T]/g, "-");

/** The kind of video that this browser can record of a canvas; undefined if it cannot. */
const filmKind = () =>
  typeof MediaRecorder === "undefined"
    ? undefined
    : VIDEO_TYPES.find((kind) => MediaRecorder.isTypeSupported(kind));

function stop(recorder: MediaRecorder): void {
  if (recorder.state !== "inactive") recorder.stop();
}

export class Capture {
  readonly tools: HTMLElement[];
  private recorder: MediaRecorder | null = null;
  private photoWanted = false;

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    const { state } = store;
    const photo = tool("photo", "Save photo", () => {
      this.photoWanted = true;
      this.world.stage.sharp = true;
    });
    const film = toggle(
      "film",
      "Record video",
      () => state.filming,
      () => (this.recorder ? stop(this.recorder) : this.record()),
    );
    film.hidden = filmKind() === undefined;
    this.tools = [photo, film];
  }

  /** Saves the picture if it is wanted, before the browser clears it. */
  drawn(): void {
    if (!this.photoWanted) return;
    this.photoWanted = false;
    this.world.stage.sharp = false;
    this.world.canvas.toBlob((picture) => {
      if (picture) saveFile(picture, `galewood-${stamp()}.png`);
      else showToast("The photo could not be saved.", "The browser returned no image.");
    }, "image/png");
  }

  /** Records until stopped, at most LONGEST_FILM_S seconds, and then saves the video. */
  private record(): void {
    const stream = this.world.canvas.captureStream(FILM_FPS);
    const recorder = new MediaRecorder(stream, { mimeType: filmKind(), videoBitsPerSecond: FILM_BITS_PER_S });
    const parts: Blob[] = [];
    recorder.ondataavailable = ({ data }) => parts.push(data);
    const timer = setTimeout(() => stop(recorder), LONGEST_FILM_S * 1000);
    recorder.onstop = () => {
      clearTimeout(timer);
      for (const track of stream.getTracks()) track.stop();
      const film = new Blob(parts, { type: "video/webm" });
      if (film.size > 0) saveFile(film, `galewood-${stamp()}.webm`);
      this.recorder = null;
      this.store.state.filming = false;
    };
    recorder.start(1000);
    this.recorder = recorder;
    this.store.state.filming = true;
    showToast("Recording video", `Press again to stop. Recording ends after ${LONGEST_FILM_S} s.`, "good");
  }
}
