/** Trees as a Galewood service lists them. */
import type { TreeFiles } from "./forest";

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

/** The trees of the service at an address that have a table. */
export async function servedTrees(service: string | URL): Promise<ServedTree[]> {
  const base = `${new URL(service, document.baseURI)}`.replace(/\/?$/, "/");
  const response = await fetch(`${base}api/trees`);
  if (!response.ok) throw new Error(`${base}: the service responded with status ${response.status}`);
  const { trees } = (await response.json()) as { trees: Listed[] };
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
