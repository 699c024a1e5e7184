import { describe, expect, test } from "vitest";
import { decodeTable, poses, TableError } from "../../web/src/core/table/table";
import { golden, random } from "./golden";

const FILE = golden("pole.safetensors");

/** The golden file with its header rewritten. */
function tampered(change: (header: Record<string, never>, metadata: Record<string, unknown>) => void): Uint8Array {
  const length = new DataView(FILE.buffer, FILE.byteOffset).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(FILE.subarray(8, 8 + length)));
  const metadata = JSON.parse(header.__metadata__.galewood);
  change(header, metadata);
  if (header.__metadata__) header.__metadata__.galewood = JSON.stringify(metadata);
  const text = new TextEncoder().encode(JSON.stringify(header));
  const out = new Uint8Array(8 + text.length + FILE.length - 8 - length);
  new DataView(out.buffer).setUint32(0, text.length, true);
  out.set(text, 8);
  out.set(FILE.subarray(8 + length), 8 + text.length);
  return out;
}

test("reads a table written by Python", () => {
  const table = decodeTable(FILE);
  expect(table.metadata.species).toBe("pole");
  expect(table.dq.length).toBe(table.metadata.records * table.metadata.modes);
  expect(table.vertexNode.length).toBe(15);
  const pose = poses(table);
  for (const start of table.trajectory.subarray(0, -1)) expect(pose[start * table.metadata.modes]).toBe(0);
});

test("reads the same table from an ArrayBuffer and at an odd offset in a larger one", () => {
  const shifted = new Uint8Array(FILE.length + 3);
  shifted.set(FILE, 3);
  expect(decodeTable(shifted.subarray(3)).dq).toEqual(decodeTable(FILE.slice().buffer).dq);
});

test("reads the same table from a Node Buffer", () => {
  expect(decodeTable(Buffer.from(FILE)).modal).toEqual(decodeTable(FILE).modal);
});

describe("versions 5 and 6", () => {
  const FORMER = { prefix: "tangent.", error: "replay_m" };
  const PRESENT = { prefix: "modal.", error: "training_m" };
  const TRAINING_M = [0.01, 0.02];

  /** The golden file, converted to this version. */
  const asVersion = (version: 5 | 6, names = version === 5 ? FORMER : PRESENT) =>
    tampered((header, metadata) => {
      for (const [name, entry] of Object.entries(header)) {
        const modal = /^(?:tangent|modal)\.(.+)$/.exec(name);
        if (!modal) continue;
        delete header[name];
        header[names.prefix + modal[1]] = entry;
      }
      Object.assign(metadata, { version, errors: { [names.error]: TRAINING_M } });
    });

  test("hold the same table under other names", () => {
    const [former, present] = [decodeTable(asVersion(5)), decodeTable(asVersion(6))];
    expect(former).toEqual(present);
    expect(former.modal).toEqual(decodeTable(FILE).modal);
    expect(present.metadata.errors).toEqual({ training_m: TRAINING_M });
  });

  test("do not accept names of the other version", () => {
    expect(() => decodeTable(asVersion(6, FORMER))).toThrow("missing tensor modal.step");
    expect(() => decodeTable(asVersion(5, PRESENT))).toThrow("missing tensor modal.step");
  });
});

describe("rejects", () => {
  test("a truncated file, wherever it is cut", () => {
    for (const share of [0, 1e-5, 0.001, 0.1, 0.5, 0.99]) {
      expect(() => decodeTable(FILE.subarray(0, Math.floor(share * FILE.length)))).toThrow(TableError);
    }
    expect(() => decodeTable(FILE.subarray(0, FILE.length - 1))).toThrow(TableError);
  });

  test("another version, with both versions in the message", () => {
    const file = tampered((_, metadata) => {
      metadata.version = 2;
    });
    expect(() => decodeTable(file)).toThrow("table version 2; this reader supports versions 5 and 6");
  });

  test("another format, no metadata, metadata out of range", () => {
    const changes: Array<(header: Record<string, never>, metadata: Record<string, unknown>) => void> = [
      (_, metadata) => Object.assign(metadata, { format: "else" }),
      (header) => delete header.__metadata__,
      (_, metadata) => Object.assign(metadata, { sigma_pa: 0 }),
      (_, metadata) => Object.assign(metadata, { weight: { initial: 0.5, maximum: 0.4, growth: 0 } }),
      (_, metadata) => Object.assign(metadata, { records: 1.5 }),
      (_, metadata) => Object.assign(metadata, { primitives: [{ vertices: 14 }] }),
    ];
    for (const change of changes) expect(() => decodeTable(tampered(change))).toThrow(TableError);
  });

  test("missing, extra and wrong-typed tensors, by name", () => {
    const missing = tampered((header) => delete header["samples.dq"]);
    expect(() => decodeTable(missing)).toThrow("missing tensor samples.dq");
    const extra = tampered((header) => Object.assign(header, { more: header["samples.dq"] }));
    expect(() => decodeTable(extra)).toThrow("unknown tensor more");
    const typed = tampered((header) => Object.assign(header["samples.dq"], { dtype: "U16" }));
    expect(() => decodeTable(typed)).toThrow("tensor samples.dq: expected I16 of rank 2");
  });

  test("a sampled range without the limit of a coupled speed", () => {
    const lacking = tampered((header) => {
      const name = Object.keys(header).find((key) => key.endsWith(".limits")) as string;
      const limits = header[name] as unknown as { shape: number[] };
      limits.shape[0] -= 1;
    });
    expect(() => decodeTable(lacking)).toThrow(TableError);
  });

  test("files with flipped bits, unless they decode to indices within range (seed 11)", () => {
    const next = random(11);
    for (let round = 0; round < 300; round++) {
      const file = FILE.slice();
      for (let flips = 0; flips < 20; flips++) file[Math.floor(next() ** 3 * file.length)] ^= 1 << Math.floor(next() * 8);
      try {
        const table = decodeTable(file);
        expect(table.candidate.every((j) => j < table.metadata.records)).toBe(true);
      } catch (error) {
        expect(error).toBeInstanceOf(TableError);
      }
    }
  });
});
