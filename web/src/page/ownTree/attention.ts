/** Whether the visitor is moving the camera at the moment, so that it must not be taken away. */

const AFTERWARDS_MS = 4000;

export class Attention {
  private held = false;
  private last_ms = Number.NEGATIVE_INFINITY;
  private readonly life = new AbortController();

  constructor(canvas: HTMLElement) {
    const { signal } = this.life;
    const touched = () => {
      this.last_ms = performance.now();
    };
    const held = () => {
      this.held = true;
    };
    const released = () => {
      if (this.held) touched();
      this.held = false;
    };
    canvas.addEventListener("pointerdown", held, { signal });
    for (const name of ["wheel", "keydown"])
      canvas.addEventListener(name, touched, { signal, passive: true });
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, released, { signal });
  }

  get isBusy(): boolean {
    return this.held || performance.now() - this.last_ms < AFTERWARDS_MS;
  }

  dispose(): void {
    this.life.abort();
  }
}
