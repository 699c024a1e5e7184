/** Pass 1 of all species with one call per step: each level of detail of each species is a rectangle of the target (nodes/nodePass.ts draws each apart). */
import {
  BufferAttribute,
  type DataTexture,
  GLSL3,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  IntType,
  Mesh,
  OrthographicCamera,
  RawShaderMaterial,
  type WebGLRenderTarget,
} from "three";
import type { DrawnMotion, NodeLevel } from "../../core/table/drawnTable";
import { LEAST_USE } from "../instanceData";
import { FLAT_SHIFT, flatTexture, halfTexture } from "../nodes/flatTexture";
import { uintTarget } from "../nodes/glslNodes";
import { writeLinks } from "../nodes/levelPass";
import type { NodeRenderer } from "../nodes/nodeGraphics";
import { nodeLayout } from "../nodes/nodeLayout";
import { PoseTexture } from "./poseTexture";
import { type SharedNodes, SpeciesNodes } from "./speciesNodes";
import { DISPLACE_ALL_GLSL, LEVEL_RECTANGLES_GLSL, SHORTEN_ALL_GLSL } from "./togetherNodeShader";

/** Room of target and poses over what the species need, so that they seldom grow. */
const ROOM_RATIO = 1.1;

/** Texels of the rows (basis or turns) of a motion. */
const rowTexels = ({ levels }: DrawnMotion): number =>
  levels.reduce((sum, { basis }) => sum + basis.length / 4, 0);

/** Values of all levels one after the other, as a texture of four channels. */
function joined(levels: readonly NodeLevel[], rowsOf: (level: NodeLevel) => Float32Array): DataTexture {
  const { texture, data } = halfTexture(levels.reduce((sum, level) => sum + rowsOf(level).length / 4, 0));
  let to = 0;
  for (const level of levels) {
    data.set(rowsOf(level), to);
    to += rowsOf(level).length;
  }
  return texture;
}

/** The links of all levels, whose nodes are numbered one level after the other. */
function joinedLinks(levels: readonly NodeLevel[]): DataTexture {
  const { texture, data } = flatTexture(
    levels.reduce((sum, { nodes }) => sum + nodes, 0),
    4,
  );
  let first = 0;
  for (const level of levels) {
    writeLinks(level, data, first);
    first += level.nodes;
  }
  return texture;
}

/** Instances of the rectangles: see LEVEL_RECTANGLES_GLSL. */
function rectangles(count: number) {
  const integers = () => {
    const attribute = new InstancedBufferAttribute(new Int32Array(4 * count), 4);
    attribute.gpuType = IntType;
    return attribute;
  };
  const geometry = new InstancedBufferGeometry();
  const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0]);
  const [places, sizes] = [integers(), integers()];
  const shares = new InstancedBufferAttribute(new Float32Array(count), 1);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setAttribute("aPlace", places);
  geometry.setAttribute("aSizes", sizes);
  geometry.setAttribute("aShare", shares);
  geometry.instanceCount = count;
  return { geometry, places, sizes, shares };
}

export class TogetherNodes implements SharedNodes {
  readonly target = uintTarget(1, 1);
  private readonly first = uintTarget(1, 1);
  readonly shift = { value: 0 };
  readonly newest = new PoseTexture();
  readonly before = new PoseTexture();
  private readonly species: SpeciesNodes[] = [];
  /** Number of species that have ever been added. */
  private added = 0;
  /** Ends of what is taken: rows of the target, texels of the poses. */
  private endRow = 0;
  private endPose = 0;
  private poseRoom = 0;
  private rows: readonly DataTexture[] = [];
  private instances = rectangles(0);
  private readonly camera = new OrthographicCamera();
  private readonly uniforms;
  private readonly meshes: readonly Mesh<InstancedBufferGeometry, RawShaderMaterial>[];
  private speciesChanged = true;
  private placesChanged = true;
  private posesChanged = true;
  /** Who has asked for the last drawing. */
  private readonly servedBy = new Set<SpeciesNodes>();

  /** `factor`: shared factor of all displacements. */
  constructor(
    private readonly maxSide: number,
    factor: { readonly value: number },
  ) {
    this.uniforms = {
      uPoses: { value: this.newest.texture },
      uBefore: { value: this.before.texture },
      uFactor: factor,
      uShift: this.shift,
      uHeight: { value: 1 },
    };
    const shortening = { uMoved: { value: this.first.texture }, uLinks: { value: null } };
    this.meshes = [this.material(DISPLACE_ALL_GLSL, {}), this.material(SHORTEN_ALL_GLSL, shortening)].map(
      (material) => {
        const mesh = new Mesh(this.instances.geometry, material);
        mesh.frustumCulled = false;
        return mesh;
      },
    );
  }

  private material(fragmentShader: string, own: RawShaderMaterial["uniforms"]): RawShaderMaterial {
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: LEVEL_RECTANGLES_GLSL,
      fragmentShader,
      depthTest: false,
      depthWrite: false,
      uniforms: { ...this.uniforms, uRows: { value: null }, ...own },
    });
  }

  /** Whether the rows of another species fit into a texture. */
  hasRoomFor(motion: DrawnMotion): boolean {
    const texels = this.species.reduce((sum, one) => sum + rowTexels(one.motion), rowTexels(motion));
    return texels <= this.maxSide * 2 ** FLAT_SHIFT;
  }

  get isEmpty(): boolean {
    return this.species.length === 0;
  }

  add(motion: DrawnMotion): SpeciesNodes {
    const own = new SpeciesNodes(this, motion, this.added++);
    this.species.push(own);
    this.speciesChanged = true;
    return own;
  }

  /** Its place in the target stays empty until that grows. */
  remove(species: SpeciesNodes): void {
    this.species.splice(this.species.indexOf(species), 1);
    this.servedBy.delete(species);
    this.speciesChanged = true;
    if (this.isEmpty) this.dispose();
  }

  changed(places: boolean): void {
    this.posesChanged = true;
    this.placesChanged ||= places;
  }

  assign(species: SpeciesNodes): void {
    const rows = species.rowsWanted(this.shift.value);
    const poses = species.posesWanted;
    if (this.endRow + rows <= this.target.height && this.endPose + poses <= this.poseRoom)
      this.append(species, rows);
    else this.assignAll(species);
  }

  release(species: SpeciesNodes): void {
    const { width, height } = this.target;
    if (ROOM_RATIO * this.texelsWanted < LEAST_USE * width * height) this.assignAll(species);
  }

  private get texelsWanted(): number {
    return this.species.reduce((sum, one) => sum + one.texelsWanted, 0);
  }

  private append(species: SpeciesNodes, rows: number): void {
    const { endRow, endPose, target } = this;
    const fitting = Math.min(rows, target.height - endRow);
    species.block = { row: endRow, rows: fitting, pose: endPose, poses: species.posesWanted };
    this.endRow += fitting;
    this.endPose += species.posesWanted;
  }

  private assignAll(growing: SpeciesNodes): void {
    const { species, target, first, uniforms } = this;
    const parts = species.reduce((sum, one) => sum + one.levels.length + 1, 0);
    const { width, height, shift } = nodeLayout(ROOM_RATIO * this.texelsWanted, parts, this.maxSide);
    this.shift.value = shift;
    target.setSize(width, height);
    first.setSize(width, height);
    this.poseRoom = Math.ceil(ROOM_RATIO * species.reduce((sum, one) => sum + one.posesWanted, 0));
    this.newest.makeRoom(this.poseRoom);
    this.before.makeRoom(this.poseRoom);
    uniforms.uPoses.value = this.newest.texture;
    uniforms.uBefore.value = this.before.texture;
    uniforms.uHeight.value = height;
    this.endRow = 0;
    this.endPose = 0;
    for (const one of species) this.append(one, one.rowsWanted(shift));
    for (const one of species) if (one !== growing) one.replace();
  }

  private prepare(): void {
    if (this.speciesChanged) this.takeSpecies();
    if (this.placesChanged) this.takePlaces();
    const { shares } = this.instances;
    this.species.forEach((one, k) => {
      shares.array.set(one.shares, k * one.shares.length);
    });
    shares.needsUpdate = true;
    this.newest.upload();
    this.before.upload();
    this.speciesChanged = false;
    this.placesChanged = false;
    this.posesChanged = false;
  }

  private takeSpecies(): void {
    const levels = this.species.flatMap((one) => one.levels);
    for (const texture of this.rows) texture.dispose();
    const basis = joined(levels, (level) => level.basis);
    const turn = joined(levels, (level) => level.turn);
    const links = joinedLinks(levels);
    this.rows = [basis, turn, links];
    const [displacing, shortening] = this.meshes;
    displacing.material.uniforms.uRows.value = basis;
    shortening.material.uniforms.uRows.value = turn;
    shortening.material.uniforms.uLinks.value = links;
    this.instances.geometry.dispose();
    this.instances = rectangles(levels.length);
    for (const mesh of this.meshes) mesh.geometry = this.instances.geometry;
    this.placesChanged = true;
  }

  private takePlaces(): void {
    const { places, sizes } = this.instances;
    let [k, rows, node] = [0, 0, 0];
    for (const one of this.species)
      for (const [index, { nodes, quads, coordinates }] of one.levels.entries()) {
        const { row, trees, pose } = one.placeOf(index);
        places.array.set([row, trees, nodes, node], 4 * k);
        sizes.array.set([quads, coordinates.length % 4, pose, rows], 4 * k);
        rows += 3 * nodes * quads;
        node += nodes;
        k++;
      }
    places.needsUpdate = true;
    sizes.needsUpdate = true;
  }

  render(by: SpeciesNodes, renderer: NodeRenderer): void {
    if (this.posesChanged || this.speciesChanged || this.servedBy.has(by)) {
      this.servedBy.clear();
      this.draw(renderer);
    }
    this.servedBy.add(by);
  }

  private draw(renderer: NodeRenderer): void {
    this.prepare();
    if (this.endRow === 0) return;
    const before = renderer.getRenderTarget();
    const { autoClear } = renderer;
    renderer.autoClear = false; // every texel that is read is drawn
    [this.first, this.target].forEach((target, k) => {
      renderer.setRenderTarget(target as WebGLRenderTarget);
      renderer.render(this.meshes[k], this.camera);
    });
    renderer.autoClear = autoClear;
    renderer.setRenderTarget(before);
  }

  private dispose(): void {
    this.target.dispose();
    this.first.dispose();
    this.instances.geometry.dispose();
    for (const { material } of this.meshes) material.dispose();
    for (const texture of [...this.rows, this.newest.texture, this.before.texture]) texture.dispose();
  }
}
