/** Draws pieces in the colour of their kind, or their rows as colours to be read back. */
import { Color, DataTexture, DoubleSide, NearestFilter, ShaderMaterial, type Texture } from "three";
import { KIND_COLOURS, type PieceKind } from "../pieces";

const TEXTURE_WIDTH = 256;

/** The colour of every piece, one texel each. */
export class PieceColours {
  readonly texture: DataTexture;
  private readonly bytes: Uint8Array;

  constructor(count: number) {
    const rows = Math.max(1, Math.ceil(count / TEXTURE_WIDTH));
    this.bytes = new Uint8Array(4 * TEXTURE_WIDTH * rows).fill(255);
    this.texture = new DataTexture(this.bytes, TEXTURE_WIDTH, rows);
    this.texture.magFilter = this.texture.minFilter = NearestFilter;
  }

  set(row: number, kind: PieceKind): void {
    const rgb = new Color(KIND_COLOURS[kind]).getHex(); // sRGB
    this.bytes.set([rgb >> 16, (rgb >> 8) & 255, rgb & 255], 4 * row);
    this.texture.needsUpdate = true;
  }
}

const VERTEX_GLSL = /* glsl */ `
attribute float piece;
flat varying int row;
varying vec3 place;
varying vec2 at;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  row = int(piece + 0.5);
  place = seen.xyz;
  at = uv;
  gl_Position = projectionMatrix * seen;
}`;

// The normal is that of the face, because pieces have none of their own.
const FRAGMENT_GLSL = /* glsl */ `
uniform sampler2D colours;
uniform sampler2D leaf;
uniform bool cutOut;
uniform bool picking;
flat varying int row;
varying vec3 place;
varying vec2 at;
void main() {
  if (cutOut && texture2D(leaf, at).a < 0.42) discard;
  if (picking) {
    int id = row + 1;
    gl_FragColor = vec4(vec3(id & 255, (id >> 8) & 255, (id >> 16) & 255) / 255.0, 1.0);
    return;
  }
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.42 + 0.58 * max(0.0, dot(normal, normalize(vec3(0.35, 0.75, 0.55))));
  gl_FragColor = vec4(texelFetch(colours, ivec2(row % ${TEXTURE_WIDTH}, row / ${TEXTURE_WIDTH}), 0).rgb * light, 1.0);
}`;

export function pieceMaterial(colours: PieceColours, map: Texture | null): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX_GLSL,
    fragmentShader: FRAGMENT_GLSL,
    uniforms: {
      colours: { value: colours.texture },
      leaf: { value: map },
      cutOut: { value: map !== null },
      picking: { value: false },
    },
    side: DoubleSide,
  });
}
