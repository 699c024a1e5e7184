/** Plants an inventory in a forest of galewood/three or galewood/webgpu. */
import type { BaseForest, TreeFiles } from "../three/baseForest";
import type { Planted } from "../three/planted";
import type { Inventory } from "./document";
import { placesOf } from "./places";

/** Height of the ground (m) at a place in the frame of the forest. */
export type Ground = (x_m: number, z_m: number) => number;

const level: Ground = () => 0;

/**
 * Plants every stem as a tree: by the name of its species, else of the built-in one that stands for it, else as the first of
 * `trees`. The middle of the plot is the forest's origin, north is −z. Returns what was planted, by the names of the trees;
 * kinds without stems are left out.
 */
export async function plantInventory<Name extends string>(
  forest: Pick<BaseForest, "plant" | "move">,
  inventory: Pick<Inventory, "stems">,
  trees: Readonly<Record<Name, TreeFiles>>,
  ground: Ground = level,
): Promise<Partial<Record<Name, Planted>>> {
  const { Matrix4 } = await import("three"); // only here, so that files can be read without it
  const names = Object.keys(trees) as Name[];
  /** Matrices of a kind whose tree is `height_m` tall. */
  const matrices = (name: Name, height_m: number) =>
    placesOf(inventory, { ...heights(names, 1), [name]: height_m })[name].map(
      ({ x_m, z_m, yaw_rad, scale }) =>
        new Matrix4()
          .makeScale(scale, scale, scale)
          .premultiply(new Matrix4().makeRotationY(yaw_rad))
          .setPosition(x_m, ground(x_m, z_m), z_m),
    );
  const planted = await Promise.all(
    names.map(async (name) => {
      const places = matrices(name, 1);
      if (places.length === 0) return [];
      const kind = await forest.plant(trees[name], places);
      forest.move(kind, matrices(name, kind.height_m)); // the height is known by now
      return [[name, kind] as const];
    }),
  );
  return Object.fromEntries(planted.flat()) as Partial<Record<Name, Planted>>;
}

const heights = <Name extends string>(names: readonly Name[], height_m: number) =>
  Object.fromEntries(names.map((name) => [name, height_m])) as Record<Name, number>;
