/** Geometry of trees for WebGPU. */
import {
  BufferAttribute,
  InstancedBufferGeometry,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  IntType,
  StaticDrawUsage,
} from "three";
import { expect, test } from "vitest";
import { adapt } from "../../../../web/player/src/webgpu/geometry";
import { random } from "../../golden";

/** What every device of WebGPU allows. */
const MOST_VERTEX_BUFFERS = 8;

test("a tree with vertex colours takes no more buffers than a device allows; no value changes (seed 3)", () => {
  const next = random(3);
  const vertices = 20;
  const filled = (columns: number) => new BufferAttribute(Float32Array.from({ length: vertices * columns }, next), columns);
  const [anchor, piece] = [filled(4), filled(4)];
  const instances = new InstancedInterleavedBuffer(new Float32Array(12), 12);
  const made = () => {
    const geometry = new InstancedBufferGeometry();
    const own = { position: filled(3), normal: filled(3), uv: filled(2), color: filled(3), aPivot: filled(3) };
    for (const [name, attribute] of Object.entries(own)) geometry.setAttribute(name, attribute);
    geometry.setAttribute("aAnchor", anchor);
    geometry.setAttribute("aPiece", piece);
    geometry.setAttribute("aJoint", new BufferAttribute(new Uint16Array(4 * vertices), 4));
    for (const [k, name] of ["aPlace", "aTurn", "aTint"].entries())
      geometry.setAttribute(name, new InterleavedBufferAttribute(instances, 4, 4 * k));
    adapt(geometry);
    return geometry;
  };
  const [first, second] = [made(), made()];
  adapt(first); // again, as when there is a larger buffer of trees
  const buffers = new Set(
    Object.values(first.attributes).map((one) => (one instanceof InterleavedBufferAttribute ? one.data : one)),
  );
  expect(buffers.size).toBe(MOST_VERTEX_BUFFERS);
  for (const [name, before] of [["aAnchor", anchor], ["aPiece", piece]] as const) {
    const after = first.getAttribute(name) as InterleavedBufferAttribute;
    for (let v = 0; v < vertices; v++) {
      for (let column = 0; column < 4; column++)
        expect(after.getComponent(v, column)).toBe(before.getComponent(v, column));
    }
    // levels of detail share them
    expect((second.getAttribute(name) as InterleavedBufferAttribute).data).toBe(after.data);
  }
  expect((first.getAttribute("aJoint") as BufferAttribute).gpuType).toBe(IntType);
  expect(instances.usage).toBe(StaticDrawUsage);
});
