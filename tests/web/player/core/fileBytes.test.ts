import { expect, test } from "vitest";
import { faultOf, fileBytes } from "../../../../web/player/src/core/net/fileBytes";

const asked = (body: string, init: ResponseInit) => async () => new Response(body, init);

test("a file is its bytes, whatever type its server gives it", async () => {
  const bytes = await fileBytes("poplar.table", asked("ab", { headers: { "content-type": "text/plain" } })());
  expect(new TextDecoder().decode(bytes)).toBe("ab");
});

test.each([
  [asked("", { status: 404 }), "trees/poplar.table: the server responded with status 404"],
  [
    asked("<!doctype html>", { headers: { "content-type": "text/html; charset=utf-8" } }),
    "trees/poplar.table: the server responded with a web page instead of this file; check the address",
  ],
  [
    async () => {
      throw new TypeError("Failed to fetch");
    },
    "trees/poplar.table: could not be loaded (Failed to fetch)",
  ],
])("a file that does not come is named in the error", async (response, said) => {
  await expect(fileBytes("trees/poplar.table", response())).rejects.toThrow(said);
});

test("a fault inside of a file names its address, once", () => {
  expect(faultOf("trees/poplar.table", new Error("not a table"))).toBe("trees/poplar.table: not a table");
  expect(faultOf("a.glb", "a.glb: not a mesh")).toBe("a.glb: not a mesh");
  expect(faultOf(new ArrayBuffer(0), new Error("not a table"))).toBe("not a table");
});
