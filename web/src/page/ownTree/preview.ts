/** Preview of the detected parts: wood in one colour, leaves in another. */
import { BufferGeometry, DoubleSide, Group, Mesh, MeshLambertMaterial } from "three";
import { PreviewStage } from "../../scene/previewStage";
import type { TreeModel, TreePart } from "../../scene/trees/mesh/treeMesh";

export const COLOURS = { wood: 0xc08a55, leaves: 0x7fb061 } as const;
const TURN_RAD_S = 0.35;

export class Preview {
  private readonly stage: PreviewStage;
  private tree: Group | null = null;

  constructor(canvas: HTMLCanvasElement) {
    this.stage = new PreviewStage(canvas);
  }

  show(model: TreeModel): void {
    this.clear();
    this.tree = new Group();
    this.tree.add(...model.parts.map(meshOf));
    this.stage.scene.add(this.tree);
    this.stage.frame(model);
  }

  /** Renders, and rotates the tree slowly unless `still`. */
  render(dt_s: number, still: boolean): void {
    if (this.tree && !still) this.tree.rotation.y += TURN_RAD_S * dt_s;
    this.stage.render();
  }

  private clear(): void {
    const { tree } = this;
    if (!tree) return;
    this.stage.scene.remove(tree);
    for (const mesh of tree.children as Mesh<BufferGeometry, MeshLambertMaterial>[]) {
      mesh.geometry.dispose();
      mesh.material.map?.dispose();
      mesh.material.dispose();
    }
    this.tree = null;
  }

  dispose(): void {
    this.clear();
    this.stage.dispose();
  }
}

function meshOf({ kind, position, normal, uv, index, material }: TreePart): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", position);
  geometry.setAttribute("normal", normal);
  if (uv) geometry.setAttribute("uv", uv);
  geometry.setIndex(index);
  const leaves = kind === "leaves";
  const look = new MeshLambertMaterial({
    color: COLOURS[kind],
    alphaMap: null,
    map: leaves ? material.map : null,
    alphaTest: leaves && material.map ? 0.42 : 0,
    side: DoubleSide,
  });
  return new Mesh(geometry, look);
}
