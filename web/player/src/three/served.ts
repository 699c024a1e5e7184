/** Trees as a Galewood service lists them. */
import { fileBytes } from "../core/net/fileBytes";
import type { TreeFiles } from "./baseForest";

/** A tree of a service that moves. */
export interface ServedTree extends TreeFiles {
  readonly id: string;
  readonly name: string;
  /** Names the table in streams. */
  readonly tableSha256: string;
}

interface Listed {
  readonly id: string;
  readonly name: string;
  readonly mesh_sha256: string | null;
  readonly table_sha256: string | null;
}

/** The list of trees in an answer from an address; throws with the address if it is something else. */
function listedIn(bytes: ArrayBuffer, address: string): Listed[] {
  try {
    const { trees } = JSON.parse(new TextDecoder().decode(bytes)) as { trees?: unknown };
    if (Array.isArray(trees)) return trees as Listed[];
  } catch {
    // said below
  }
  throw new Error(`${address}: this is not the list of trees of a Galewood service; check its address`);
}

/** The trees of the service at an address that have a table. Rejects with the address if no service answers there. */
export async function servedTrees(service: string | URL): Promise<ServedTree[]> {
  const base = `${new URL(service, document.baseURI)}`.replace(/\/?$/, "/");
  const address = `${base}api/trees`;
  const trees = listedIn(await fileBytes(address, fetch(address)), address);
  return trees.flatMap(({ id, name, mesh_sha256: mesh, table_sha256: table }) =>
    mesh && table
      ? [
          {
            id,
            name,
            tableSha256: table,
            table: `${base}api/tables/${table}`,
            mesh: `${base}api/light-meshes/${mesh}`,
          },
        ]
      : [],
  );
}
