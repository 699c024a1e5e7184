/** Bodies on the forest floor: stones, fallen trunks, stumps and mushrooms, of size 1, with texture coordinates around and along. */
import { hashUnit } from "galewood/random";
import {
  BufferAttribute,
  type BufferGeometry,
  CylinderGeometry,
  IcosahedronGeometry,
  LatheGeometry,
  Vector2,
  Vector3,
} from "three";
import { mergeGeometries, mergeVertices } from "three/addons/utils/BufferGeometryUtils.js";

const HASH_SEED = 419;

/** Moves every vertex and computes the normals anew. */
function shaped(geometry: BufferGeometry, move: (at: Vector3) => void): BufferGeometry {
  const position = geometry.getAttribute("position");
  const at = new Vector3();
  for (let v = 0; v < position.count; v++) {
    at.fromBufferAttribute(position, v);
    move(at);
    position.setXYZ(v, at.x, at.y, at.z);
  }
  geometry.computeVertexNormals();
  return geometry;
}

/** A boulder of height about 1: some planes cut it, which leaves edges. */
export function stone(): BufferGeometry {
  const ball = new IcosahedronGeometry(1, 3);
  ball.deleteAttribute("uv");
  ball.deleteAttribute("normal");
  const planes = Array.from({ length: 9 }, (_, k) => {
    const at = (channel: number) => hashUnit(HASH_SEED, k, channel);
    const angle = 2 * Math.PI * at(0);
    const up = 1.6 * at(1) - 0.6;
    return {
      along: new Vector3(Math.cos(angle), up, Math.sin(angle)).normalize(),
      from: 0.62 + 0.22 * at(2),
    };
  });
  const body = shaped(mergeVertices(ball), (at) => {
    for (const { along, from } of planes) {
      const over = at.dot(along) - from;
      if (over > 0) at.addScaledVector(along, -0.85 * over);
    }
    at.x *= 0.95;
    at.y = 0.55 * at.y + 0.35;
    at.z *= 0.72;
  });
  return withRoundCoordinates(body);
}

function withRoundCoordinates(geometry: BufferGeometry): BufferGeometry {
  const position = geometry.getAttribute("position");
  const uv = new Float32Array(2 * position.count);
  for (let v = 0; v < position.count; v++)
    uv.set([position.getX(v) + 0.4 * position.getY(v), position.getZ(v)], 2 * v);
  return geometry.setAttribute("uv", new BufferAttribute(uv, 2));
}

/** A fallen trunk of length 1 along x, thinner towards its end, with the stubs of some branches. */
export function trunkOnGround(): BufferGeometry {
  const radius = 0.042;
  const stem = shaped(new CylinderGeometry(0.55 * radius, radius, 1, 12, 8), (at) => {
    const bend = 0.05 * Math.sin(2.6 * at.y + 0.4);
    const knots = 1 + 0.1 * Math.sin(9 * at.y + 2 * Math.atan2(at.z, at.x));
    at.x = knots * at.x + bend;
    at.z *= knots;
  });
  const stubs = [0, 1, 2].map((k) => {
    const stub = new CylinderGeometry(0.2 * radius, 0.32 * radius, 0.12, 6, 1);
    stub.translate(0, 0.06 + 0.5 * radius, 0);
    stub.rotateX(0.9);
    stub.rotateY(2.1 * k + 0.5);
    stub.translate(0, 0.05 + 0.17 * k, 0);
    return stub;
  });
  const whole = mergeGeometries([stem, ...stubs]);
  whole.rotateZ(Math.PI / 2);
  whole.translate(0, 0.75 * radius, 0);
  return whole;
}

/** What is left of a felled tree: height 1, wider at its foot. */
export function stump(): BufferGeometry {
  const body = new CylinderGeometry(0.52, 0.6, 1, 16, 5);
  return shaped(body.translate(0, 0.5, 0), (at) => {
    const angle = Math.atan2(at.z, at.x);
    const foot = Math.exp(-3.2 * at.y);
    const factor = 1 + foot * (0.35 + 0.35 * Math.cos(5 * angle + 0.7)) + 0.04 * Math.sin(7 * angle);
    at.x *= factor;
    at.z *= factor;
    if (at.y > 0.99) at.y += 0.1 * at.x + 0.04 * Math.sin(3 * angle); // the cut is not level
  });
}

/** Cap and stem of height 1; the cap has texture coordinates above 0.5. */
export function mushroom(): BufferGeometry {
  const outline: readonly (readonly [number, number])[] = [
    [0.13, 0],
    [0.1, 0.3],
    [0.09, 0.66],
    [0.42, 0.62],
    [0.44, 0.68],
    [0.34, 0.86],
    [0.18, 0.97],
    [0.001, 1],
  ];
  return new LatheGeometry(
    outline.map(([out, up]) => new Vector2(out, up)),
    10,
  );
}
