/** A forest that is stepped on the graphics device. */
import type { Renderer, StorageBufferNode, WebGPUBackend } from "three/webgpu";
import { Forest, type ForestOptions } from "../../core/forest/forest";
import type { Table } from "../../core/table/table";
import { ComputedTrees } from "./computedTrees";

/**
 * The forest of galewood/core, whose oscillators are stepped by a compute shader: the wind is evaluated on the processor and uploaded per
 * step, the state stays on the graphics device. Displacements and vertices are those of the last `read`.
 */
export class ComputedForest extends Forest {
  private readonly kinds: ComputedTrees[];

  /** `renderer`: initialised, and on WebGPU; throws on WebGL 2, which has no such shaders. */
  constructor(renderer: Renderer, options: ForestOptions) {
    if (!(renderer.backend as WebGPUBackend).isWebGPUBackend)
      throw new Error(
        "ComputedForest needs WebGPU: await renderer.init() first; without WebGPU use galewood/core",
      );
    const kinds: ComputedTrees[] = [];
    super(
      options,
      class extends ComputedTrees {
        constructor(table: Table, count: number) {
          super(renderer, table, count);
          kinds.push(this);
        }
      },
    );
    this.kinds = kinds;
  }

  /** [trees, modes] coordinates (m) of the trees of a kind, as an input of your own shaders. */
  storage(kind: number): StorageBufferNode<"float"> {
    return this.kinds[kind].coordinates;
  }

  /** Bytes on the graphics device per tree of a kind. */
  bytesPerTree(kind: number): number {
    return this.kinds[kind].bytesPerTree;
  }

  /** Copies the present coordinates to the processor, for `coordinates`, `nodes` and `vertices`. */
  async read(): Promise<void> {
    await Promise.all(this.kinds.map((trees) => trees.read()));
  }

  /** Frees the memory of the graphics device. */
  dispose(): void {
    for (const trees of this.kinds) trees.dispose();
  }
}
