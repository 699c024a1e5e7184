/** Instanced cards of one species: one draw call for the colour pass, one for the shadow maps. */
import { isSpacious, roomFor } from "galewood/trees";
import {
  BufferAttribute,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  Mesh,
  type MeshLambertMaterial,
  type Object3D,
} from "three";
import type { Atlas } from "./baking/atlas";
import { type CardUniforms, cardMaterials } from "./cardMaterial";

/** Floats per card: x y z opacity | s·cos s·sin s random | tint rgb, strength. */
export const CARD_FLOATS = 12;
/** Floats of the bend per card: texels of two nodes, or two displacements of the tip. */
export const BEND_FLOATS = 4;
/** Rows of the card, so that it can bend. */
const CARD_ROWS = 5;

function grid(): { corners: Float32Array; index: number[] } {
  const corners = new Float32Array((CARD_ROWS + 1) * 2 * 3);
  const index: number[] = [];
  for (let row = 0; row <= CARD_ROWS; row++) {
    const y = (2 * row) / CARD_ROWS - 1;
    corners.set([-1, y, 0, 1, y, 0], row * 6);
    const a = 2 * row;
    if (row < CARD_ROWS) index.push(a, a + 1, a + 3, a, a + 3, a + 2);
  }
  return { corners, index };
}

type CardMesh = Mesh<InstancedBufferGeometry, MeshLambertMaterial>;

/** The instances of one pass. */
export class CardList {
  private buffer = new InstancedInterleavedBuffer(new Float32Array(0), CARD_FLOATS);
  private bends = new InstancedBufferAttribute(new Float32Array(0), BEND_FLOATS);
  private room = 0;
  count = 0;

  constructor(readonly mesh: CardMesh) {
    const { corners, index } = grid();
    mesh.geometry.setAttribute("position", new BufferAttribute(corners, 3));
    mesh.geometry.setIndex(index);
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    mesh.visible = false;
  }

  /** Makes room for this many cards; fill `data` and `bend`, then call `show`. */
  reserve(count: number): void {
    if (this.room > 0 && count <= this.room && !isSpacious(this.room, count)) return;
    this.room = roomFor(Math.max(1, count));
    this.buffer = new InstancedInterleavedBuffer(new Float32Array(this.room * CARD_FLOATS), CARD_FLOATS);
    this.buffer.setUsage(DynamicDrawUsage);
    this.bends = new InstancedBufferAttribute(new Float32Array(this.room * BEND_FLOATS), BEND_FLOATS);
    this.bends.setUsage(DynamicDrawUsage);
    const { geometry } = this.mesh;
    geometry.dispose(); // what has been drawn is bound to the former buffers
    ["aPlace", "aTurn", "aTint"].forEach((name, k) => {
      geometry.setAttribute(name, new InterleavedBufferAttribute(this.buffer, 4, 4 * k));
    });
    geometry.setAttribute("aBend", this.bends);
  }

  get data(): Float32Array {
    return this.buffer.array as Float32Array;
  }

  get bend(): Float32Array {
    return this.bends.array as Float32Array;
  }

  show(count: number): void {
    this.count = count;
    this.mesh.geometry.instanceCount = count;
    this.mesh.visible = count > 0;
    if (count === 0) return;
    this.buffer.clearUpdateRanges();
    this.buffer.addUpdateRange(0, count * CARD_FLOATS);
    this.buffer.needsUpdate = true;
    this.moved();
  }

  /** Call after a change of `bend`. */
  moved(): void {
    if (this.count === 0) return;
    this.bends.clearUpdateRanges();
    this.bends.addUpdateRange(0, this.count * BEND_FLOATS);
    this.bends.needsUpdate = true;
  }
}

export class Cards {
  readonly seen: CardList;
  readonly casting: CardList;
  readonly uniforms: CardUniforms = {
    uNodes: { value: null },
    uNodeShift: { value: 0 },
    uShare: { value: 1 },
  };
  private readonly materials: ReturnType<typeof cardMaterials>;

  /** `middle`: height of the middle node of simulated trees, relative to the tree's; null for others. */
  constructor(
    readonly atlas: Atlas,
    middle: number | null,
  ) {
    this.materials = cardMaterials(atlas, this.uniforms, middle);
    const make = () => new Mesh(new InstancedBufferGeometry(), this.materials.colour);
    this.seen = new CardList(make());
    this.casting = new CardList(make());
    this.seen.mesh.renderOrder = 4; // behind the trees, before the ground
    this.seen.mesh.receiveShadow = true;
    const { mesh } = this.casting;
    mesh.castShadow = true;
    mesh.customDepthMaterial = this.materials.shadow;
    // Only the shadow maps draw this mesh.
    mesh.onBeforeShadow = () => {
      mesh.geometry.instanceCount = this.casting.count;
    };
    mesh.onBeforeRender = () => {
      mesh.geometry.instanceCount = 0;
    };
  }

  addTo(group: Object3D): void {
    group.add(this.seen.mesh, this.casting.mesh);
  }

  hide(): void {
    this.seen.show(0);
    this.casting.show(0);
  }

  dispose(): void {
    for (const { mesh } of [this.seen, this.casting]) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    this.materials.colour.dispose();
    this.materials.shadow.dispose();
  }
}
