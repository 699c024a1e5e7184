/** What WebGPU asks of the geometry of trees. */
import {
  type BufferAttribute,
  type BufferGeometry,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  IntType,
  StaticDrawUsage,
} from "three";

/** The attributes of pieces share one buffer, because a device may read no more than eight for a vertex. */
const together = new WeakMap<BufferAttribute, InterleavedBuffer>();

function interleaved(anchor: BufferAttribute, piece: BufferAttribute): InterleavedBuffer {
  const known = together.get(anchor);
  if (known) return known;
  const both = new Float32Array(8 * anchor.count);
  for (let v = 0; v < anchor.count; v++) {
    both.set(anchor.array.slice(4 * v, 4 * v + 4), 8 * v);
    both.set(piece.array.slice(4 * v, 4 * v + 4), 8 * v + 4);
  }
  const buffer = new InterleavedBuffer(both, 8);
  together.set(anchor, buffer);
  return buffer;
}

/** Prepares the geometry of trees, whenever its attributes are set. */
export function adapt(geometry: BufferGeometry): void {
  (geometry.getAttribute("aJoint") as BufferAttribute).gpuType = IntType; // in shaders they are whole numbers
  const [anchor, piece] = [geometry.getAttribute("aAnchor"), geometry.getAttribute("aPiece")];
  if (!(anchor instanceof InterleavedBufferAttribute)) {
    const buffer = interleaved(anchor, piece as BufferAttribute);
    geometry.setAttribute("aAnchor", new InterleavedBufferAttribute(buffer, 4, 0));
    geometry.setAttribute("aPiece", new InterleavedBufferAttribute(buffer, 4, 4));
  }
  // WebGPURenderer uploads dynamic buffers for every picture, shadow maps included, others when they have changed.
  const places = geometry.getAttribute("aPlace");
  if (places instanceof InterleavedBufferAttribute) places.data.setUsage(StaticDrawUsage);
}
