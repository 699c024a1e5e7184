/** Dropped files that are no trees: documents are read in the page, tables by the service. */
import { afterEach, describe, expect, test, vi } from "vitest";
import { CALM_BREEZE } from "../../../web/player/src/core/wind/presets";
import { contentOf } from "../../../web/src/page/files/content";

const STEM = { line: 1, east_m: 0, north_m: 0, species: "oak", builtin: "maple", height_m: 9, slender: true };
const STAND = { version: 1, stems: [STEM], report: { figures: { Trees: "1 of 1 rows" }, notes: [] } };
const MEASURED = { wind: CALM_BREEZE, report: { figures: {}, notes: [] } };

/** Answers all requests with this, and returns what is sent. */
function service(status: number, body: unknown) {
  const answer = vi.fn(async (_path: string, _init?: RequestInit) => new Response(JSON.stringify(body), { status }));
  vi.stubGlobal("fetch", answer);
  return answer;
}

afterEach(() => void vi.unstubAllGlobals());

const file = (content: unknown, name = "a.csv") =>
  new File([typeof content === "string" ? content : JSON.stringify(content)], name);

describe("documents", () => {
  test("are read without a service", async () => {
    const sent = service(500, {});
    const { line: _, ...stem } = STEM;
    expect(await contentOf(file(STAND, "a.json"))).toEqual({ kind: "inventory", inventory: { stems: [stem], report: STAND.report } });
    expect(await contentOf(file(` \n${JSON.stringify(CALM_BREEZE)}`, "a.json"))).toEqual({ kind: "wind", wind: CALM_BREEZE });
    expect(sent).not.toHaveBeenCalled();
  });

  test.each([
    [{ ...CALM_BREEZE, gustiness: 7 }, "The wind file is invalid.", "wind.gustiness: expected a number in 0..1, not 7"],
    [{ ...STAND, version: 2 }, "The inventory could not be read.", "version: this reader knows version 1, not 2."],
  ])("with an error are refused with its place", async (document, title, hint) => {
    await expect(contentOf(file(document, "a.json"))).rejects.toMatchObject({ title, hint });
  });
});

describe("tables", () => {
  test("are sent as they are, and become what the service makes of them", async () => {
    const sent = service(200, STAND);
    const stand = file("x,y,height\n0,0,9\n");
    expect(await contentOf(stand)).toMatchObject({ kind: "inventory", inventory: { stems: [{ species: "oak" }] } });
    expect(sent).toHaveBeenCalledWith("api/convert?start_s=0", expect.objectContaining({ method: "POST", body: stand }));
    service(200, MEASURED);
    expect(await contentOf(file("time,speed\n0,3\n"))).toEqual({ kind: "measurement", found: MEASURED });
  });

  test("GeoJSON is sent, too; JSON that is broken is refused", async () => {
    const sent = service(200, STAND);
    await contentOf(file('{"type": "FeatureCollection", "features": []}', "a.geojson"));
    expect(sent).toHaveBeenCalledOnce();
    await expect(contentOf(file('{"stems": [', "a.json"))).rejects.toMatchObject({
      title: "The file is not valid JSON.",
    });
    expect(sent).toHaveBeenCalledOnce();
  });

  test("of another kind may be trees", async () => {
    service(415, { title: "The file is not a table of measurements.", hint: "" });
    expect(await contentOf(file("branch,radius\n1,2\n"))).toBeNull();
  });

  test("with an error have that of the service, which names the line", async () => {
    const hint = "Line 2, column 'speed': 'fast' is not a number.";
    service(422, { title: "The measurement could not be read.", hint });
    await expect(contentOf(file("time,speed\n0,fast\n"))).rejects.toMatchObject({ hint });
  });

  test.each([404, 405, 501])("need a service: status %i says how to convert them", async (status) => {
    service(status, "<html>");
    await expect(contentOf(file("x,y,height\n"))).rejects.toMatchObject({
      title: "Only a service can read this file.",
      hint: expect.stringContaining("`galewood convert`"),
    });
  });
});
