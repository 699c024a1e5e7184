import { createHash } from "node:crypto";
import { describe, expect, test } from "vitest";
import { decodeRecords, type Records, recordsOf } from "../../../../web/player/src/core/table/records";
import { decodeTable, type Table, TableError } from "../../../../web/player/src/core/table/table";
import { tableMotion } from "../../../../web/player/src/worker/table/tableMotion";
import { golden, random } from "../../golden";
import { tampered } from "../../tableFile";

const FILE = golden("pole.safetensors");
const ALONE = golden("pole-table.safetensors");
const LINEAR = golden("pole-linear.safetensors");
const RECORDS = golden("pole-records.safetensors");
const SHA256 = createHash("sha256").update(ALONE).digest("hex");

const withRecords = (table: Table) => table as Table & { paper: Records };

test("reads a table written by Python", () => {
  const { metadata, vertexNode, paper, modal } = withRecords(decodeTable(FILE));
  expect(metadata.species).toBe("pole");
  expect(metadata.reach_m).toBeGreaterThan(0);
  expect(metadata.peak_pressure_pa).toBeGreaterThan(10);
  expect(metadata.paper).toBeUndefined();
  expect(vertexNode.length).toBe(15);
  expect(paper.dq.length).toBe(paper.metadata.records * metadata.modes);
  const [places, points, d] = [modal.place.length / 3, modal.dragPoint.length / 2, modal.shown.length];
  expect(places).toBeGreaterThan(0);
  expect([modal.dragPlace.length, modal.placeLoad.length]).toEqual([points * places, 2 * d * places]);
});

test("reads the same table from an ArrayBuffer and at an odd offset in a larger one", () => {
  const shifted = new Uint8Array(FILE.length + 3);
  shifted.set(FILE, 3);
  expect(decodeTable(shifted.subarray(3))).toEqual(decodeTable(FILE.slice().buffer));
});

test("reads the same table from a Node Buffer", () => {
  expect(decodeTable(Buffer.from(FILE)).modal).toEqual(decodeTable(FILE).modal);
});

describe("a table without records", () => {
  test("is the same table, and its records file holds the same records", () => {
    const whole = decodeTable(FILE);
    expect(decodeTable(ALONE)).toEqual({ ...whole, paper: null });
    const { modes } = whole.metadata;
    expect(recordsOf(RECORDS, { sha256: SHA256, modes })).toEqual(whole.paper);
  });

  test("does not accept records of another table, or of another number of modes", () => {
    const other = createHash("sha256").update(FILE).digest("hex");
    const { modes } = decodeTable(FILE).metadata;
    expect(() => recordsOf(RECORDS, { sha256: other, modes })).toThrow("these records belong to another table");
    expect(() => recordsOf(RECORDS, { sha256: SHA256, modes: modes - 1 })).toThrow(TableError);
  });

  test("may consist of oscillators alone: tensors of size zero", () => {
    const { modal, metadata } = decodeTable(LINEAR);
    expect([metadata.modes, modal.shown.length, modal.pose.length, modal.limits.length]).toEqual([5, 5, 0, 3]);
    expect(tableMotion("", decodeTable(LINEAR), 0)).toMatchObject({
      preliminary: true,
      linear: true,
      hasRecords: false,
      leftOut: ["large deflections", "streamlining"],
    });
    expect(tableMotion("", decodeTable(FILE), 0)).toMatchObject({ preliminary: false, linear: false, hasRecords: true });
  });
});

describe("rejects", () => {
  const all = [
    ["a table with records", FILE, decodeTable],
    ["a table without", ALONE, decodeTable],
    ["a linear table", LINEAR, decodeTable],
    ["records", RECORDS, decodeRecords],
  ] as const;

  test.each(all)("a truncated file, wherever it is cut: %s", (_, file, decode) => {
    for (const share of [0, 1e-5, 0.001, 0.1, 0.5, 0.99]) {
      expect(() => decode(file.subarray(0, Math.floor(share * file.length)))).toThrow(TableError);
    }
    expect(() => decode(file.subarray(0, file.length - 1))).toThrow(TableError);
    expect(() => decode(Uint8Array.from([...file.subarray(0, 3000), ...file.subarray(2999)]))).toThrow(TableError);
  });

  test("random bytes, and a file of the other kind", () => {
    const next = random(5);
    for (let round = 0; round < 100; round++) {
      const file = Uint8Array.from({ length: 300 }, () => 256 * next());
      file.set([round, 0, 0, 0, 0, 0, 0, 0]);
      for (const decode of [decodeTable, decodeRecords]) expect(() => decode(file)).toThrow(TableError);
    }
    expect(() => decodeTable(RECORDS)).toThrow("not a galewood-table: format galewood-records");
    expect(() => decodeRecords(FILE)).toThrow("not a galewood-records: format galewood-table");
  });

  test("another version, with the known one in the message", () => {
    for (const version of [0, 2, 10, "1", true]) {
      const file = tampered(FILE, (_, metadata) => Object.assign(metadata, { version }));
      expect(() => decodeTable(file)).toThrow(`table version ${version}; this reader knows version 1`);
    }
    const file = tampered(RECORDS, (_, metadata) => Object.assign(metadata, { version: 2 }));
    expect(() => decodeRecords(file)).toThrow("records version 2; this reader knows version 1");
  });

  test("another format, no metadata, metadata out of range", () => {
    const changes: Parameters<typeof tampered>[1][] = [
      (_, metadata) => Object.assign(metadata, { format: "else" }),
      (header) => delete header.__metadata__,
      (_, metadata) => Object.assign(metadata, { reach_m: -1 }),
      (_, metadata) => Object.assign(metadata, { reach_m: undefined }),
      (_, metadata) => Object.assign(metadata, { peak_pressure_pa: "10" }),
      (_, metadata) => Object.assign(metadata, { streamlined_exponent: undefined }),
      (_, metadata) => Object.assign(metadata, { streamlined_exponent: 0.99 }),
      (_, metadata) => Object.assign(metadata, { streamlined_exponent: 2.01 }),
      (_, metadata) => Object.assign(metadata.paper as object, { sigma_pa: 0 }),
      (_, metadata) => Object.assign(metadata.paper as object, { weight: { initial: 0.5, maximum: 0.4, growth: 0 } }),
      (_, metadata) => Object.assign(metadata.paper as object, { records: 1.5 }),
      (_, metadata) => Object.assign(metadata, { paper: [] }),
      (_, metadata) => Object.assign(metadata, { primitives: [{ vertices: 14 }] }),
      (_, metadata) => Object.assign(metadata, { foliage: "needles" }),
    ];
    for (const change of changes) expect(() => decodeTable(tampered(FILE, change))).toThrow(TableError);
  });

  test("records without their metadata, and metadata without records", () => {
    const bare = tampered(FILE, (_, metadata) => delete metadata.paper);
    expect(() => decodeTable(bare)).toThrow("metadata paper: missing");
    const { metadata } = decodeRecords(RECORDS).records;
    const empty = tampered(ALONE, (_, all) => Object.assign(all, { paper: metadata }));
    expect(() => decodeTable(empty)).toThrow("missing tensor samples.dq");
  });

  test("missing, extra and wrong-typed tensors, by name", () => {
    for (const [file, decode] of [[FILE, decodeTable], [RECORDS, decodeRecords]] as const) {
      const missing = tampered(file, (header) => delete header["samples.dq"]);
      expect(() => decode(missing)).toThrow("missing tensor samples.dq");
      const extra = tampered(file, (header) => Object.assign(header, { more: header["samples.dq"] }));
      expect(() => decode(extra)).toThrow("unknown tensor more");
      const typed = tampered(file, (header) => Object.assign(header["samples.dq"], { dtype: "U16" }));
      expect(() => decode(typed)).toThrow("tensor samples.dq: expected I16 of rank 2");
    }
  });

  test("a header that is not UTF-8", () => {
    const file = ALONE.slice();
    const at = Buffer.from(file).indexOf("wood_0");
    file[at] = 0xff;
    expect(() => decodeTable(file)).toThrow("the metadata is unreadable");
  });

  test("tensors that overlap", () => {
    const offsets = (header: Record<string, never>, name: string) => header[name] as { data_offsets: number[] };
    const file = tampered(FILE, (header) => {
      offsets(header, "modes.scale").data_offsets = offsets(header, "modal.step").data_offsets.slice(0, 2);
      const bytes = 4 * decodeTable(FILE).metadata.modes;
      offsets(header, "modes.scale").data_offsets[1] = offsets(header, "modes.scale").data_offsets[0] + bytes;
    });
    expect(() => decodeTable(file)).toThrow("tensors overlap");
  });

  test("a sampled range without the limit of a coupled speed", () => {
    const lacking = tampered(FILE, (header) => {
      const name = Object.keys(header).find((key) => key.endsWith(".limits")) as string;
      const limits = header[name] as unknown as { shape: number[] };
      limits.shape[0] -= 1;
    });
    expect(() => decodeTable(lacking)).toThrow(TableError);
  });

  test.each(all)("files with flipped bits, unless they decode to indices within range (seed 11): %s", (_, from, decode) => {
    const next = random(11);
    for (let round = 0; round < 150; round++) {
      const file = from.slice();
      for (let flips = 0; flips < 20; flips++) file[Math.floor(next() ** 3 * file.length)] ^= 1 << Math.floor(next() * 8);
      try {
        const decoded = decode(file);
        const records = "paper" in decoded ? decoded.paper : "records" in decoded ? decoded.records : null;
        if (records) expect(records.candidate.every((j) => j < records.metadata.records)).toBe(true);
      } catch (error) {
        expect(error).toBeInstanceOf(TableError);
      }
    }
  });
});
