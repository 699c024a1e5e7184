/** Displacements of the vertices of pulled trees that the modes do not show, as the worker sent them. */

/** The worker keeps fewer, so that it sends again whatever is missing here. */
const MOST_KEPT = 16;

export class PullFields {
  private readonly fields = new Map<string, Float32Array>();

  add(table: string, vertex: number, field: Float32Array): void {
    for (const old of this.fields.keys()) if (this.fields.size >= MOST_KEPT) this.fields.delete(old);
    this.fields.set(`${table}:${vertex}`, field);
  }

  /** [vertices, 3, 3] m per N; null while unknown, or if the tree has no compliance file. */
  get(table: string, vertex: number): Float32Array | null {
    return this.fields.get(`${table}:${vertex}`) ?? null;
  }
}
