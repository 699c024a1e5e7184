/** The contents of a file that was asked for. */

/** What went wrong with a file, with its address unless that is in it already; contents have none. */
export function faultOf(from: unknown, error: unknown): string {
  const fault = error instanceof Error ? error.message : `${error}`;
  return typeof from !== "string" || fault.includes(from) ? fault : `${from}: ${fault}`;
}

/** What `fetch` answers. */
interface FileResponse {
  readonly ok: boolean;
  readonly status: number;
  readonly headers: { get(name: string): string | null };
  arrayBuffer(): Promise<ArrayBuffer>;
}

/**
 * The bytes of a response that is a file. Rejects with the address if there is none: also when a server answers any
 * address that it does not know with a page, as those of single-page applications do.
 */
export async function fileBytes(from: string, asked: Promise<FileResponse>): Promise<ArrayBuffer> {
  const response = await asked.catch((error: unknown) => {
    throw new Error(`${from}: could not be loaded (${faultOf(null, error)})`);
  });
  if (!response.ok) throw new Error(`${from}: the server responded with status ${response.status}`);
  if (response.headers.get("content-type")?.startsWith("text/html"))
    throw new Error(`${from}: the server responded with a web page instead of this file; check the address`);
  return response.arrayBuffer();
}
