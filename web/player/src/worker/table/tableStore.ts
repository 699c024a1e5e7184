/**
 * The tables and records that this worker has fetched, by the hash of the table. No cache of requests: the page's catalogue
 * orders each file when it changes, in this thread, because decoded tables are too large to be sent between threads.
 */

import { fileBytes } from "../../core/net/fileBytes";
import { type Compliance, decodeCompliance } from "../../core/pull/compliance";
import { type Records, recordsOf } from "../../core/table/records";
import { decodeTable, type Table } from "../../core/table/table";

const fetchBytes = (url: string) => fileBytes(url, fetch(url));

export class TableStore {
  private readonly tables = new Map<string, { readonly table: Table; readonly bytes: number }>();
  private readonly records = new Map<string, Records>();

  private readonly compliances = new Map<string, Compliance | null>();

  /** Fetches and decodes a compliance file, once; one that cannot be read counts as missing. */
  async loadCompliance(url: string): Promise<void> {
    const file = await fetchBytes(url).then(decodeCompliance, () => null);
    this.compliances.set(url, file);
  }

  /** A compliance file by its address; null if there is none. */
  complianceAt(url: string): Compliance | null {
    return this.compliances.get(url) ?? null;
  }

  /** Fetches and decodes a table. */
  async load(sha256: string, url: string): Promise<{ table: Table; bytes: number }> {
    const file = await fetchBytes(url);
    const loaded = { table: decodeTable(file), bytes: file.byteLength };
    this.tables.set(sha256, loaded);
    return loaded;
  }

  /** Fetches and decodes the records of a table that is already loaded. */
  async loadRecords(table: string, url: string): Promise<void> {
    const { modes } = this.table(table).metadata;
    this.records.set(table, recordsOf(await fetchBytes(url), { sha256: table, modes }));
  }

  table(sha256: string): Table {
    const found = this.tables.get(sha256);
    if (!found) throw new Error(`table ${sha256} is used before it was loaded`);
    return found.table;
  }

  /** The records of a table, from its own file or a later one; null if they are not here. */
  recordsOf(sha256: string): Records | null {
    return this.table(sha256).paper ?? this.records.get(sha256) ?? null;
  }

  /** Size of a table's file. */
  bytes(sha256: string): number {
    return this.tables.get(sha256)?.bytes ?? 0;
  }
}
