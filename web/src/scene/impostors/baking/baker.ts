/** Draws the views of trees into their atlases, a few per frame. */

import type { TreePart } from "galewood/trees";
import {
  BufferAttribute,
  BufferGeometry,
  Camera,
  Color,
  DoubleSide,
  FrontSide,
  GLSL3,
  Mesh,
  NearestFilter,
  RawShaderMaterial,
  Scene,
  type Texture,
  Vector2,
  Vector3,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { meanColour } from "../../treeModel/meanColour";
import { type Atlas, VIEW_COUNT } from "./atlas";
import { COLOUR_VIEW, SURFACE_VIEW, viewCorner } from "./atlasLayout";
import { BAKE_FRAGMENT, BAKE_VERTEX, REDUCE_FRAGMENT, REDUCE_VERTEX } from "./bakeShader";
import { pictureAxes, VIEWS_PER_SIDE, viewDirection } from "./octahedral";

/** Leaves are cut out here; the same as where they are drawn. */
const CUT_ALPHA = 0.42;

function geometryOf(part: TreePart): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setIndex(part.index);
  geometry.setAttribute("position", part.position);
  geometry.setAttribute("normal", part.normal);
  if (part.uv) geometry.setAttribute("uv", part.uv);
  geometry.setAttribute("aPiece", part.piece);
  geometry.setAttribute("aAnchor", part.anchor);
  return geometry;
}

/** From afar a tree painted by its vertices has their mean colour. */
function evenly(color: Color, colour: BufferAttribute | null): Color {
  const mean = meanColour(colour?.array ?? null);
  return mean ? color.clone().multiply(new Color(...mean)) : color;
}

/** Axes of the picture, shared by all materials. */
const axes = () => ({
  uRight: { value: new Vector3() },
  uUp: { value: new Vector3() },
  uTowards: { value: new Vector3() },
});

function triangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute(
    "position",
    new BufferAttribute(Float32Array.from([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3),
  );
  return geometry;
}

/** The meshes of one tree, while its views are drawn. */
class Sitter {
  readonly scene = new Scene();
  private readonly geometries: BufferGeometry[] = [];
  private readonly materials: RawShaderMaterial[] = [];
  private readonly blank = new BufferAttribute(new Float32Array(2), 2);

  constructor(
    readonly atlas: Atlas,
    uniforms: ReturnType<typeof axes>,
  ) {
    const { across_m, up_m, middle_m } = atlas.box;
    const perMetre = new Vector3(1 / across_m, 1 / up_m, 1 / across_m);
    const { parts, bare } = atlas.model;
    const inLeaf = parts.filter(({ kind }) => kind === "wood" || !atlas.leafless);
    for (const part of [...inLeaf, ...(atlas.leafless ? bare.map((shoots) => shoots.part) : [])]) {
      const leaves = part.kind === "leaves";
      const { map, color, alphaTest, transparent } = part.material;
      const geometry = geometryOf(part);
      if (!part.uv) geometry.setAttribute("uv", this.noUv(part.vertices));
      const material = new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: BAKE_VERTEX,
        fragmentShader: BAKE_FRAGMENT,
        side: leaves ? DoubleSide : FrontSide,
        uniforms: {
          ...uniforms,
          uPerMetre: { value: perMetre },
          uMiddle: { value: middle_m },
          uMap: { value: map },
          uMapped: { value: map !== null && part.uv !== null },
          uColour: { value: evenly(color, part.colour) },
          uCut: { value: leaves && (alphaTest > 0 || transparent) ? CUT_ALPHA : 0 },
          uLeaves: { value: leaves },
        },
      });
      const mesh = new Mesh(geometry, material);
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      this.geometries.push(geometry);
      this.materials.push(material);
    }
  }

  private noUv(vertices: number): BufferAttribute {
    return vertices * 2 === this.blank.array.length
      ? this.blank
      : new BufferAttribute(new Float32Array(vertices * 2), 2);
  }

  dispose(): void {
    for (const geometry of this.geometries) geometry.dispose();
    for (const material of this.materials) material.dispose();
  }
}

export class Baker {
  private readonly axes = axes();
  private readonly camera = new Camera();
  private readonly screen = triangle();
  private readonly reduction: RawShaderMaterial;
  private readonly reduced = new Scene();
  private canvas: WebGLRenderTarget | null = null;
  private sitter: Sitter | null = null;

  /** `side`: pixels of the picture from which each view is reduced, a multiple of the views' width and height. */
  constructor(readonly side: number) {
    this.reduction = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: REDUCE_VERTEX,
      fragmentShader: REDUCE_FRAGMENT,
      depthTest: false,
      depthWrite: false,
      uniforms: {
        ...this.axes,
        uColour: { value: null as Texture | null },
        uSurface: { value: null as Texture | null },
        uFrom: { value: new Vector2() },
        uBlock: { value: new Vector2(1, 1) },
        uOfSurface: { value: false },
        uSize: { value: new Vector2(1, 1) },
      },
    });
    const mesh = new Mesh(this.screen, this.reduction);
    mesh.frustumCulled = false;
    this.reduced.add(mesh);
  }

  /** Draws the next `views` views of an atlas. */
  work(renderer: WebGLRenderer, atlas: Atlas, views: number): void {
    if (this.sitter?.atlas !== atlas || atlas.done === 0) {
      this.sitter?.dispose();
      this.sitter = new Sitter(atlas, this.axes);
    }
    const target = renderer.getRenderTarget();
    const clear = renderer.getClearColor(new Color());
    const { autoClear } = renderer;
    const opacity = renderer.getClearAlpha();
    renderer.setClearColor(0, 0);
    for (let k = 0; k < views && !atlas.isBaked; k++) this.draw(renderer, atlas, this.sitter);
    renderer.setClearColor(clear, opacity);
    renderer.autoClear = autoClear;
    renderer.setRenderTarget(target);
    if (atlas.isBaked) atlas.complete = true;
  }

  private draw(renderer: WebGLRenderer, atlas: Atlas, { scene }: Sitter): void {
    const view = atlas.done++;
    const direction = viewDirection(view % VIEWS_PER_SIDE, Math.floor(view / VIEWS_PER_SIDE));
    const { right, up } = pictureAxes(direction);
    this.axes.uRight.value.set(...right);
    this.axes.uUp.value.set(...up);
    this.axes.uTowards.value.set(...direction);
    this.canvas ??= this.makeCanvas();
    renderer.autoClear = true;
    renderer.setRenderTarget(this.canvas);
    renderer.render(scene, this.camera);
    renderer.autoClear = false;
    this.reduce(renderer, this.canvas, atlas.colour, view, false);
    this.reduce(renderer, this.canvas, atlas.surface, view, true);
  }

  private makeCanvas(): WebGLRenderTarget {
    return new WebGLRenderTarget(this.side, this.side, {
      count: 2,
      minFilter: NearestFilter,
      magFilter: NearestFilter,
    });
  }

  private reduce(
    renderer: WebGLRenderer,
    canvas: WebGLRenderTarget,
    picture: WebGLRenderTarget,
    view: number,
    surface: boolean,
  ): void {
    const { width, height } = surface ? SURFACE_VIEW : COLOUR_VIEW;
    const { left, bottom } = viewCorner(view, { width, height });
    const { uniforms } = this.reduction;
    uniforms.uColour.value = canvas.textures[0];
    uniforms.uSurface.value = canvas.textures[1];
    uniforms.uFrom.value.set(left, bottom);
    uniforms.uBlock.value.set(this.side / width, this.side / height);
    uniforms.uOfSurface.value = surface;
    uniforms.uSize.value.set(width, height);
    picture.viewport.set(left, bottom, width, height);
    picture.scissor.set(left, bottom, width, height);
    // Mip levels once, with the last view.
    picture.texture.generateMipmaps = view === VIEW_COUNT - 1;
    renderer.setRenderTarget(picture);
    renderer.render(this.reduced, this.camera);
  }

  /** Frees what is only needed while baking. */
  rest(): void {
    this.sitter?.dispose();
    this.sitter = null;
    this.canvas?.dispose();
    this.canvas = null;
  }

  /** After a loss of the graphics context, with which everything went. */
  forget(): void {
    this.sitter = null;
    this.canvas = null;
  }

  dispose(): void {
    this.rest();
    this.screen.dispose();
    this.reduction.dispose();
  }
}
