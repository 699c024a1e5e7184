/** Trees of one table whose modal step is a compute shader: the processor has their wind and clocks, the graphics device their state. */
import { instanceIndex, storage, uniform, wgslFn } from "three/tsl";
import {
  type ComputeNode,
  type Renderer,
  StorageBufferAttribute,
  type StorageBufferNode,
  type WebGPUBackend,
} from "three/webgpu";
import type { PlaceGusts } from "../../core/modal/placeGusts";
import { TreeInstances } from "../../core/motion/treeInstances";
import type { Table } from "../../core/table/table";
import { DRIVE_FLOATS, type ModalSizes, modalCode } from "./modalWgsl";

const NO_STATES = new Float32Array(0);

/** Most bytes of a buffer that shaders use. */
const mostBytes = ({ backend }: Renderer): number =>
  (
    backend as WebGPUBackend & {
      readonly device: { readonly limits: { readonly maxStorageBufferBindingSize: number } };
    }
  ).device.limits.maxStorageBufferBindingSize;

export class ComputedTrees extends TreeInstances {
  /** [count, modes] displayed coordinates (m), for shaders. */
  readonly coordinates: StorageBufferNode<"float">;
  /** [count, drive] commands of a frame to each tree. */
  private readonly drive: StorageBufferAttribute;
  private readonly buffers: readonly StorageBufferAttribute[];
  private readonly compute: ComputeNode;
  private readonly sizes: ModalSizes;
  private readonly local: Float32Array;

  /** `renderer`: on WebGPU, initialised. */
  constructor(
    private readonly renderer: Renderer,
    { modal, metadata }: Table,
    count: number,
  ) {
    super(count, metadata.modes, metadata.dt_s, NO_STATES);
    const { sizes, model, step, includes } = modalCode(modal, metadata.modes, metadata.dt_s);
    this.sizes = sizes;
    const fitting = Math.floor(mostBytes(renderer) / (4 * sizes.state));
    if (count > fitting)
      throw new RangeError(
        `${count} trees of a kind: this graphics device takes ${fitting}. Plant them as several kinds, or give ` +
          "WebGPURenderer a larger maxStorageBufferBindingSize as requiredLimits",
      );
    this.local = new Float32Array(2 * sizes.places);
    const [tensors, state, drive, shown] = [
      model,
      sizes.state * count,
      sizes.drive * count,
      sizes.modes * count,
    ].map((of) => new StorageBufferAttribute(of instanceof Float32Array ? of : new Float32Array(of), 1));
    this.buffers = [tensors, state, drive, shown];
    this.drive = drive;
    this.coordinates = storage(shown, "float", shown.count);
    const stepTree = wgslFn(step, includes.map((code) => wgslFn(code)) as never[]);
    this.compute = stepTree({
      model: storage(tensors, "float", tensors.count).toReadOnly(),
      state: storage(state, "float", state.count),
      drive: storage(drive, "float", drive.count).toReadOnly(),
      shown: this.coordinates,
      tree: instanceIndex,
      count: uniform(count, "uint"),
    } as never).compute(count);
  }

  /** Bytes on the graphics device per tree. */
  get bytesPerTree(): number {
    const { state, drive, modes } = this.sizes;
    return 4 * (state + drive + modes);
  }

  /** Notes one more step of tree i in this frame. */
  protected step(i: number, px: number, pz: number): void {
    const at = i * this.sizes.drive;
    const { array } = this.drive;
    array[at] = px;
    array[at + 1] = pz;
    array[at + 2] += 1;
    if (array[at + 2] > 1) return; // the same wind as in the first step
    const gusty = this.gusts?.write(this.standing, i, px, pz, this.local) ?? false;
    array[at + 4] = gusty ? 1 : 0;
    if (gusty) array.set(this.local, at + DRIVE_FLOATS);
  }

  protected show(i: number, part: number): void {
    this.drive.array[i * this.sizes.drive + 3] = part;
  }

  override advance(
    dt_s: number,
    pressureX: ArrayLike<number>,
    pressureZ: ArrayLike<number>,
    gusts: PlaceGusts | null = null,
  ): void {
    const { drive, sizes, count } = this;
    for (let i = 0; i < count; i++) drive.array[i * sizes.drive + 2] = 0;
    super.advance(dt_s, pressureX, pressureZ, gusts);
    drive.needsUpdate = true;
    this.renderer.compute(this.compute);
  }

  /** Copies the displayed coordinates from the graphics device to `q`. */
  async read(): Promise<void> {
    this.q.set(new Float32Array(await this.renderer.getArrayBufferAsync(this.buffers[3])));
  }

  /** Frees the memory of the graphics device. */
  dispose(): void {
    for (const buffer of this.buffers) buffer.dispose();
    this.compute.dispose();
  }
}
