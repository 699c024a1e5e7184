/** Poses of the drawn trees of all species, as a texture of which only what was written is uploaded. */
import { halfTexture, uploadRuns } from "../nodes/flatTexture";

export class PoseTexture {
  private flat = halfTexture(0);
  private readonly written: (readonly [number, number])[] = [];

  get texture() {
    return this.flat.texture;
  }

  /** Four floats per texel. */
  get data(): Float32Array {
    return this.flat.data;
  }

  /** Replaces the texture by an empty one. */
  makeRoom(texels: number): void {
    this.texture.dispose();
    this.flat = halfTexture(texels);
    this.written.length = 0;
  }

  /** Call when texels have been written. */
  mark(from: number, end: number): void {
    this.written.push([from, end]);
  }

  /** Has what was written uploaded when the texture is used next. */
  upload(): void {
    if (this.written.length > 0) uploadRuns(this.texture, this.written);
    this.written.length = 0;
  }
}
