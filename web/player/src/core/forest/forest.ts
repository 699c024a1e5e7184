/** A forest without pictures: tables and places in, displacements of nodes and vertices out. */
import { JointWind } from "../motion/jointWind";
import { type Jointed, NodePose } from "../motion/nodePose";
import type { SteppedTrees } from "../motion/steppedTrees";
import type { Table } from "../table/table";
import { WindField } from "../wind/field";
import { checkedWind, GivenWind, type Point, velocityAt, type Wind } from "./givenWind";
import { advance, type Make, treesOf } from "./trees";

/** Where a tree stands. */
export interface Place {
  readonly x_m: number;
  readonly z_m: number;
  /** Only for winds that are functions. Default: 0. */
  readonly y_m?: number;
  /** Rotation about the vertical. Default: 0. */
  readonly yaw_rad?: number;
  /** Size relative to the table's tree, which also slows the motion down. Default: 1. */
  readonly scale?: number;
}

/** Trees that share a table. */
export interface Kind {
  readonly table: Table;
  readonly places: readonly Place[];
}

export interface ForestOptions {
  readonly kinds: readonly Kind[];
  readonly wind: Wind;
  /** Time (s) at which the forest starts, at rest. Default: 0. */
  readonly time_s?: number;
}

/** The nodes of a tree, in the frame of the tree and at scale 1; n nodes. The next call for the same kind overwrites it. */
export interface TreeNodes {
  /** [n, 3] displacement from rest, m. */
  readonly displacement_m: Float32Array;
  /** [n, 3] rotation vector; its length lies between the sine and the tangent of the angle. */
  readonly rotation: Float32Array;
}

interface Grove {
  readonly first: number;
  readonly count: number;
  readonly places: readonly Place[];
  readonly trees: SteppedTrees;
  readonly pose: NodePose;
}

/** The nodes and joints of a table, by which its vertices move. */
export function jointsOf(table: Table): Jointed {
  const { modes } = table.metadata;
  return {
    stride: modes,
    modes,
    nodes: table.nodeRest.length / 3,
    basis: table.nodeBasis,
    turn: table.nodeTurn,
    rest_m: table.nodeRest,
    parent: table.nodeParent,
    jointNodes: table.jointNodes,
    jointShare: table.jointShare,
    jointRest_m: table.jointRest,
    vertexJoint: table.vertexJoint,
  };
}

const placementOf = (places: readonly Place[]): Float32Array =>
  Float32Array.from(places.flatMap(({ x_m, z_m, yaw_rad = 0, scale = 1 }) => [x_m, z_m, yaw_rad, scale]));

function checkPlaces(places: readonly Place[]): void {
  for (const [k, { x_m, z_m, y_m = 0, yaw_rad = 0, scale = 1 }] of places.entries()) {
    if (![x_m, z_m, y_m, yaw_rad].every(Number.isFinite) || !(scale > 0 && scale < 100))
      throw new RangeError(`places[${k}]: expected finite x_m, z_m, yaw_rad and a scale in 0..100`);
  }
}

/** Trees of any number of tables in one wind. Trees are numbered in the order of `kinds`. */
export class Forest {
  /** Number of trees. */
  readonly count: number;
  private readonly groves: readonly Grove[];
  private readonly joint: JointWind;
  private field: WindField;
  private now_s: number;

  /** `make`: what steps the trees, if not the processor. */
  constructor({ kinds, wind, time_s = 0 }: ForestOptions, make?: Make) {
    this.now_s = time_s;
    let first = 0;
    this.groves = kinds.map(({ table, places }) => {
      checkPlaces(places);
      const trees = treesOf(table, placementOf(places), make);
      const grove = { first, count: places.length, places, trees, pose: new NodePose(jointsOf(table)) };
      first += places.length;
      return grove;
    });
    this.count = first;
    this.joint = new JointWind(this.groves.map(({ trees }) => trees.wind));
    this.field = this.fieldOf(checkedWind(wind));
  }

  /** Time of the forest, s. */
  get time_s(): number {
    return this.now_s;
  }

  /** Changes the wind: from one document to another within 0.6 s, otherwise at once. Throws WindError if it is none. */
  setWind(given: Wind): void {
    const wind = checkedWind(given);
    if (typeof wind === "function" || this.field instanceof GivenWind) this.field = this.fieldOf(wind);
    else this.field.change(wind, this.now_s);
  }

  private fieldOf(wind: Wind): WindField {
    if (typeof wind !== "function") return new WindField(wind);
    const places = this.groves.flatMap((grove) => grove.places);
    const at: Point = { x: 0, y: 0, z: 0 };
    return new GivenWind((x, z, time_s, outX, outZ) => {
      for (let i = 0; i < x.length; i++) {
        [at.x, at.y, at.z] = [x[i], places[i].y_m ?? 0, z[i]];
        const velocity = velocityAt(wind, at, time_s);
        outX[i] = velocity.x;
        outZ[i] = velocity.z;
      }
    });
  }

  /** Advances by dt_s (s), in steps of at most 1/30 s. Throws RangeError for what is no time. */
  step(dt_s: number): void {
    const trees = this.groves.map((grove) => grove.trees);
    this.now_s = advance(trees, this.joint, this.field, this.now_s, dt_s);
  }

  /** The modal coordinates (m) of a tree: a view of the present ones, which the next step changes. */
  coordinates(tree: number): Float32Array {
    const { grove, row } = this.find(tree);
    const { modes, lookup } = grove.trees;
    return lookup.q.subarray(row * modes, (row + 1) * modes);
  }

  /** Displacements and rotations of the nodes of a tree. */
  nodes(tree: number): TreeNodes {
    const { moved, turned } = this.pose(tree);
    return { displacement_m: moved, rotation: turned };
  }

  /**
   * Where vertices of a tree are, in the frame of the tree and at scale 1: apply scale, yaw and position to them, as to the
   * vertices at rest. `rest_m`: their places in the mesh, xyz packed, beginning with vertex number `first` of the
   * table, which counts through all primitives.
   */
  vertices(
    tree: number,
    rest_m: ArrayLike<number>,
    out: Float32Array = new Float32Array(rest_m.length),
    first = 0,
  ): Float32Array {
    const pose = this.pose(tree);
    const at = new Float64Array(3);
    for (let v = 0, i = 0; i < rest_m.length; v++, i += 3) {
      pose.place(first + v, rest_m[i], rest_m[i + 1], rest_m[i + 2], at);
      out.set(at, i);
    }
    return out;
  }

  private pose(tree: number): NodePose {
    const { grove, row } = this.find(tree);
    return grove.pose.take(grove.trees.lookup.q, row * grove.trees.modes);
  }

  private find(tree: number): { grove: Grove; row: number } {
    const grove = this.groves.find(({ first, count }) => tree >= first && tree < first + count);
    if (!grove) throw new RangeError(`tree ${tree}: expected a number in 0..${this.count - 1}`);
    return { grove, row: tree - grove.first };
  }
}

/** Creates a forest at rest. */
export const createForest = (options: ForestOptions): Forest => new Forest(options);
