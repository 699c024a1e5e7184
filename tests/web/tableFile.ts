/** Changes to tables and records files, for tests. */

type Change = (header: Record<string, never>, metadata: Record<string, unknown>) => void;

/** The file with its header rewritten. */
export function tampered(file: Uint8Array, change: Change): Uint8Array {
  const length = new DataView(file.buffer, file.byteOffset).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(file.subarray(8, 8 + length)));
  const metadata = JSON.parse(header.__metadata__.galewood);
  change(header, metadata);
  if (header.__metadata__) header.__metadata__.galewood = JSON.stringify(metadata);
  const text = new TextEncoder().encode(JSON.stringify(header));
  const out = new Uint8Array(8 + text.length + file.length - 8 - length);
  new DataView(out.buffer).setUint32(0, text.length, true);
  out.set(text, 8);
  out.set(file.subarray(8 + length), 8 + text.length);
  return out;
}
