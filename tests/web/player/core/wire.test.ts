import { describe, expect, test } from "vitest";
import {
  decodeReply,
  decodeRequest,
  encodeReply,
  encodeRequest,
  type Reply,
  type Request,
  WireError,
} from "../../../../web/player/src/core/wire/wire";
import { golden, goldenJson, random } from "../../golden";

type Plain = Record<string, unknown> & { type: string };
const said = goldenJson<{ requests: Record<string, Plain>; replies: Record<string, Plain> }>("wire/messages.json");
const refused = goldenJson<{ name: string; at: "server" | "client"; hex: string }[]>("wire/refused.json");

const file = (name: string) => golden(`wire/${name}.bin`).slice();
const fromHex = (hex: string) => Uint8Array.from(hex.match(/../g) ?? [], (byte) => Number.parseInt(byte, 16));

/** A message in the form of the JSON file: typed arrays become lists. */
const plain = (message: Request | Reply): unknown =>
  JSON.parse(JSON.stringify(message, (_, value) => (ArrayBuffer.isView(value) ? [...(value as Int8Array)] : value)));

const treesOf = ({ trees }: Plain) => (trees ? { trees: new Float32Array(trees as number[]) } : {});

function requestOf(message: Plain): Request {
  return { ...message, ...treesOf(message) } as Request;
}

function replyOf(message: Plain): Reply {
  if (message.type === "table") return { ...message, data: new Uint8Array(message.data as number[]) } as Reply;
  if (message.type !== "frame") return { ...message, ...treesOf(message) } as unknown as Reply;
  const rows = message.groups as { values: number[] }[];
  const groups = rows.map((row) => ({ ...row, values: new Int32Array(row.values) }));
  return { ...message, groups } as unknown as Reply;
}

describe("golden messages written by Python", () => {
  test.each(Object.entries(said.requests))("request %s", (name, message) => {
    expect(plain(decodeRequest(file(name).buffer))).toEqual(message);
    expect(encodeRequest(requestOf(message))).toEqual(file(name));
  });

  test.each(Object.entries(said.replies))("reply %s", (name, message) => {
    expect(plain(decodeReply(file(name).buffer))).toEqual(message);
    expect(encodeReply(replyOf(message))).toEqual(file(name));
  });
});

test.each(refused)("$name is rejected", ({ at, hex }) => {
  const decode = at === "server" ? decodeRequest : decodeReply;
  expect(() => decode(fromHex(hex).buffer)).toThrow(WireError);
});

test("another version is rejected with both versions in the message", () => {
  const data = file("pong");
  data[2] = 7;
  expect(() => decodeReply(data.buffer)).toThrow("wire version 7; this reader knows version 1");
});

test("rows of a key frame are views into the message", () => {
  const data = file("frame_key");
  const frame = decodeReply(data.buffer);
  if (frame.type !== "frame") throw new Error("not a frame");
  expect(frame.groups.every((group) => group.values.buffer === data.buffer)).toBe(true);
});

test("damaged messages are either rejected or decoded (seed 5)", () => {
  const next = random(5);
  const names = Object.keys(said.replies);
  const files = names.map(file);
  let bad = 0;
  for (let round = 0; round < 3000; round++) {
    const data = files[Math.floor(next() * names.length)].slice();
    const damaged = data.slice(0, next() < 0.3 ? Math.floor(next() * data.length) : data.length);
    if (damaged.length) damaged[Math.floor(next() * damaged.length)] = Math.floor(next() * 256);
    try {
      decodeReply(damaged.buffer);
    } catch (error) {
      expect(error).toBeInstanceOf(WireError);
      bad++;
    }
  }
  expect(bad).toBeGreaterThan(1000);
});
