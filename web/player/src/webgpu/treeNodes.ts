/** TSL of pass 2: what trees/treeShader.ts does in GLSL for trees that stand as matrices say and lack no limbs. */
import type { Texture } from "three";
import {
  attribute,
  clamp,
  cross,
  dot,
  Fn,
  float,
  If,
  int,
  inverseSqrt,
  min,
  mix,
  normalGeometry,
  normalize,
  normalLocal,
  step,
  texture,
  uniform,
  vec2,
  vec3,
  vec4,
} from "three/tsl";
import { type Node, Vector2 } from "three/webgpu";
import { MOST_LEAF_GROWTH, SHRINK_RANK_WIDTH } from "../core/constants";
import { WHOLE_SHARE } from "../trees/jointAttribute";
import { AHEAD_X_S_PER_M, AHEAD_Z_S_PER_M } from "../trees/leafFlutter";
import type { Part } from "../trees/mesh/partArrays";
import type { TreeUniforms } from "../trees/treeShader";
import { live, texelAt } from "./nodePass";
import { leafAngle, leafAxis, type Turn, turnedAbout, turnedBy, turnOf, type Vector } from "./turn";

/** See trees/treeShader.ts. */
const place = attribute("aPlace", "vec4");
const turn = attribute("aTurn", "vec4");
const tint = attribute("aTint", "vec4");
const anchor = attribute("aAnchor", "vec4");
const piece = attribute("aPiece", "vec4");
const joint = attribute("aJoint", "uvec4");
const pivot = attribute("aPivot", "vec3");

interface Held {
  readonly moved: Vector;
  readonly wind: Node<"float">;
  readonly turned: Turn;
}

/** Displacement and turn of the joint of the vertex, and the wind there. */
function heldBy(moved: Texture, turned: Texture, shift: Node<"int">): Held {
  const tree = int(place.w.add(0.5)).toVar();
  const [places, curls] = [texture(moved), texture(turned)];
  const first = tree.add(int(joint.x)).toVar();
  const at = texelAt(places, first, shift).toVar();
  const curl = texelAt(curls, first, shift).xyz.toVar();
  const wind = at.w.toVar();
  If(joint.z.greaterThan(0), () => {
    const second = tree.add(int(joint.y)).toVar();
    const share = float(joint.z).div(WHOLE_SHARE).toVar();
    at.assign(mix(at, texelAt(places, second, shift), share));
    curl.assign(mix(curl, texelAt(curls, second, shift).xyz, share));
  });
  return { moved: at.xyz, wind, turned: turnOf(curl) };
}

/** Size of the piece of the vertex at the share of pieces that its tree shows. */
function pieceSize(): Node<"float"> {
  const share = turn.w;
  const size = share
    .mul(1 + SHRINK_RANK_WIDTH)
    .sub(piece.w)
    .div(share.mul(SHRINK_RANK_WIDTH));
  return clamp(size, 0, 1);
}

/** From the frame of the tree to that of the forest, without its scales across. */
function spun(v: Vector): Vector {
  const q = vec4(turn.xy, tint.xy).toVar();
  const along = q.xyz;
  return v
    .mul(q.w.mul(q.w).sub(dot(along, along)))
    .add(along.mul(dot(along, v)).add(cross(along, v).mul(q.w)).mul(2));
}

/**
 * Where the vertex of a tree is, in the frame of the forest. Sets the normal too. `rest`: where it is at rest, in the frame of
 * the tree. `leafShare`: share of the leaves on the trees.
 */
export function swaying(
  part: Part,
  rest: Vector,
  { uNodes, uNodeShift, uFlutter, uLeafHz }: TreeUniforms,
  leafShare: { readonly value: number },
): Node<"vec3"> {
  const [moved, turned] = uNodes.value?.renderTarget?.textures ?? [];
  if (!turned) throw new Error("galewood/webgpu draws trees that move");
  const leaves = part === "leaves";
  const shift = uniform(0, "int").onRenderUpdate(() => uNodeShift.value);
  const flutter = uniform(new Vector2()).onRenderUpdate((_, { value }) =>
    value.set(uFlutter.value.x, uFlutter.value.y),
  );
  return Fn(() => {
    const held = heldBy(moved, turned, shift);
    const across = vec3(tint.z, 1, tint.w);
    normalLocal.assign(normalize(spun(turnedBy(held.turned, normalGeometry).div(across))));
    const size = pieceSize();
    const grown = (leaves ? size.mul(min(MOST_LEAF_GROWTH, inverseSqrt(min(turn.w, 1)))) : size).toVar();
    const local = mix(anchor.xyz, rest, grown).toVar();
    if (leaves) {
      const time = flutter.x.add(dot(place.xz, vec2(AHEAD_X_S_PER_M, AHEAD_Z_S_PER_M)));
      const angle = flutter.y
        .mul(piece.z)
        .mul(leafAngle(piece.x, float(uLeafHz.value), held.wind, time))
        .toVar();
      local.assign(anchor.xyz.add(turnedAbout(leafAxis(piece.x), angle, local.sub(anchor.xyz))));
    }
    // A branch that shrinks to its base ends there.
    const about = (leaves ? pivot : mix(anchor.xyz, pivot, grown)).toVar();
    local.assign(about.add(held.moved).add(turnedBy(held.turned, local.sub(about))));
    if (leaves) local.mulAssign(step(piece.x, live(leafShare))); // fallen leaves collapse to a point
    return place.xyz.add(spun(local.mul(across)));
  })();
}
