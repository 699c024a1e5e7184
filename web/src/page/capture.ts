/** Photos and short videos of the canvas, saved as files. */

import { saveFile } from "./ui/saveFile";

const FILM_FPS = 30;
export const LONGEST_FILM_S = 20;
const FILM_BITS_PER_S = 8_000_000;
const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

const stamp = () => new Date().toISOString().slice(0, 19).replace(/[:T]/g, "-");

/** Saves the current canvas. Call right after drawing, before the browser clears it. */
export function savePhoto(canvas: HTMLCanvasElement): Promise<void> {
  return new Promise((done, failed) => {
    canvas.toBlob((blob) => {
      if (!blob) return failed(new Error("The browser returned no image."));
      saveFile(blob, `galewood-${stamp()}.png`);
      done();
    }, "image/png");
  });
}

/** Whether this browser can record a canvas. */
export const canFilm = () =>
  typeof MediaRecorder !== "undefined" && KINDS.some((kind) => MediaRecorder.isTypeSupported(kind));

/** Records the canvas until stopped, at most LONGEST_FILM_S seconds, and then saves the video. */
export class Film {
  private readonly recorder: MediaRecorder;
  private readonly timer: ReturnType<typeof setTimeout>;

  constructor(canvas: HTMLCanvasElement, ended: () => void) {
    const mimeType = KINDS.find((kind) => MediaRecorder.isTypeSupported(kind));
    const stream = canvas.captureStream(FILM_FPS);
    this.recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: FILM_BITS_PER_S });
    const parts: Blob[] = [];
    this.recorder.ondataavailable = ({ data }) => parts.push(data);
    this.recorder.onstop = () => {
      for (const track of stream.getTracks()) track.stop();
      const film = new Blob(parts, { type: "video/webm" });
      if (film.size > 0) saveFile(film, `galewood-${stamp()}.webm`);
      ended();
    };
    this.recorder.start(1000);
    this.timer = setTimeout(() => this.stop(), LONGEST_FILM_S * 1000);
  }

  stop(): void {
    clearTimeout(this.timer);
    if (this.recorder.state !== "inactive") this.recorder.stop();
  }
}
