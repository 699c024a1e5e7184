/**
 * Ground-truth ambient occlusion (Jimenez and others, "Practical Real-Time Strategies for Accurate Indirect Occlusion", 2016), by
 * three.js: sky light that stems, leaves and plants keep from each other within a metre or two. The picture is drawn into a
 * target, darkened, and then shown.
 */
import {
  DepthTexture,
  HalfFloatType,
  NoBlending,
  type PerspectiveCamera,
  type Scene,
  ShaderMaterial,
  UnsignedIntType,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { GTAOPass } from "three/addons/postprocessing/GTAOPass.js";
import { FullScreenQuad } from "three/addons/postprocessing/Pass.js";

/** Objects within this distance of a point occlude it, m. */
const RADIUS_M = 1.6;
const SAMPLE_COUNT = 12;
/** Smoothed edges, as those of the canvas. */
const EDGE_SAMPLES = 4;
/** Occlusion is computed at this share of the resolution. */
const RESOLUTION_SHARE = 0.5;
/** It fades out between these distances (m), where haze is in front of it and a metre is a few pixels. */
const FADE_M = [45, 110] as const;
/** Share of the light that it takes where nothing of the sky is seen: some of it comes from the sun. */
const OCCLUSION_STRENGTH = 0.65;

const VERTEX_SHADER = /* glsl */ `
varying vec2 vUv;
void main() {
  vUv = uv;
  gl_Position = vec4(position.xy, 1.0, 1.0);
}
`;

const FRAGMENT_SHADER = /* glsl */ `
#include <common>
#include <packing>
uniform sampler2D uPicture;
uniform sampler2D uOcclusion;
uniform highp sampler2D uDepth;
uniform vec2 uRange; // near and far plane, m
varying vec2 vUv;
void main() {
  gl_FragColor = vec4(texture2D(uPicture, vUv).rgb, 1.0);
  float far_m = -perspectiveDepthToViewZ(texture2D(uDepth, vUv).r, uRange.x, uRange.y);
  float near = ${OCCLUSION_STRENGTH} * (1.0 - smoothstep(${FADE_M[0].toFixed(1)}, ${FADE_M[1].toFixed(1)}, far_m));
  gl_FragColor.rgb *= mix(1.0, texture2D(uOcclusion, vUv).r, near);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;

export class AmbientOcclusion {
  private readonly picture = new WebGLRenderTarget(1, 1, {
    type: HalfFloatType,
    samples: EDGE_SAMPLES,
    depthTexture: new DepthTexture(1, 1, UnsignedIntType),
  });
  private readonly pass: GTAOPass;
  private readonly quad: FullScreenQuad;
  private readonly size = new Vector2();

  constructor(
    private readonly renderer: WebGLRenderer,
    private readonly scene: Scene,
    private readonly camera: PerspectiveCamera,
  ) {
    const { depthTexture, texture } = this.picture;
    this.pass = new GTAOPass(scene, camera, 1, 1, { depthTexture: depthTexture ?? undefined });
    this.pass.output = GTAOPass.OUTPUT.Off;
    this.pass.updateGtaoMaterial({
      radius: RADIUS_M,
      samples: SAMPLE_COUNT,
      distanceFallOff: 1,
      thickness: 1,
    });
    const material = new ShaderMaterial({
      vertexShader: VERTEX_SHADER,
      fragmentShader: FRAGMENT_SHADER,
      uniforms: {
        uPicture: { value: texture },
        uOcclusion: { value: this.pass.gtaoMap },
        uDepth: { value: depthTexture },
        uRange: { value: new Vector2(camera.near, camera.far) },
      },
      blending: NoBlending,
      depthTest: false,
      depthWrite: false,
    });
    this.quad = new FullScreenQuad(material);
  }

  private fit(): void {
    const { x, y } = this.renderer.getDrawingBufferSize(this.size);
    if (this.picture.width === x && this.picture.height === y) return;
    this.picture.setSize(x, y);
    this.pass.setSize(Math.ceil(RESOLUTION_SHARE * x), Math.ceil(RESOLUTION_SHARE * y));
  }

  /** Draws the scene to the canvas. */
  render(): void {
    const { renderer, picture } = this;
    this.fit();
    renderer.setRenderTarget(picture);
    renderer.render(this.scene, this.camera);
    this.pass.render(renderer, picture, picture, 0, false);
    renderer.setRenderTarget(null);
    this.quad.render(renderer);
  }

  dispose(): void {
    this.picture.dispose();
    this.pass.dispose();
    (this.quad.material as ShaderMaterial).dispose();
    this.quad.dispose();
  }
}
