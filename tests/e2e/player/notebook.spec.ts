/** The example notebook: executed by a kernel, then its widget shown as a notebook shows it. */
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { WIND_PRESETS } from "../../../web/player/src/core/constants";
import { expect, test } from "../forest";
import { swaying } from "../swaying";

const REPOSITORY = resolve(__dirname, "../../..");
const STATE = "application/vnd.jupyter.widget-state+json";
const VIEW = "application/vnd.jupyter.widget-view+json";

interface Saved {
  model_name: string;
  state: Record<string, unknown>;
  buffers?: { path: string[]; encoding: "base64"; data: string }[];
}

interface Notebook {
  cells: { cell_type: string; source: string[]; outputs?: { output_type: string; data: Record<string, unknown> }[] }[];
  metadata: { widgets: Record<string, { state: Record<string, Saved> }> };
}

test.use({ drawn: "always" });

let folder = "";
let notebook: Notebook;
test.beforeAll(() => {
  folder = mkdtempSync(join(tmpdir(), "galewood-notebook-"));
  const own = join(REPOSITORY, ".venv/bin/python");
  const python = existsSync(own) ? own : "python3";
  execFileSync(python, ["-m", "tests.e2e.player.execute_notebook", folder], { cwd: REPOSITORY, stdio: "pipe" });
  notebook = JSON.parse(readFileSync(join(folder, "forest.ipynb"), "utf8")) as Notebook;
});
test.afterAll(() => rmSync(folder, { recursive: true, force: true }));

/** The widget that the first cell shows, as the notebook keeps it. */
function shown(): Saved {
  const outputs = notebook.cells.flatMap((cell) => cell.outputs ?? []);
  expect(outputs.map((one) => one.output_type)).toEqual(["execute_result", "execute_result"]);
  const { model_id } = outputs[0].data[VIEW] as { model_id: string };
  return notebook.metadata.widgets[STATE].state[model_id];
}

interface Host {
  saved: Record<string, unknown>[];
  change(name: string, value: unknown): void;
  end(): void;
}

test("the example notebook shows trees that sway, in a wind that Python and the page change", { tag: "@long" }, async ({ page }) => {
  const widget = shown();
  expect(widget.model_name).toBe("AnyModel");
  await page.route("http://notebook.test/", (route) =>
    route.fulfill({ contentType: "text/html", body: "<!doctype html><title>cell</title><div id=cell></div>" }),
  );
  await page.setViewportSize({ width: 390, height: 300 });
  await page.goto("http://notebook.test/");
  // A model and a module as anywidget has them: binary state as DataView, the source imported from a blob.
  await page.evaluate(async ({ state, buffers = [] }) => {
    const values: Record<string, unknown> = { ...state, height_px: 180 };
    for (const { path, data } of buffers)
      values[path[0]] = new DataView(Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0)).buffer);
    const listeners: Record<string, (() => void)[]> = {};
    let unsaved: Record<string, unknown> = {};
    const host: Host = {
      saved: [],
      change(name, value) {
        values[name] = value;
        for (const listen of listeners[`change:${name}`] ?? []) listen();
      },
      end: () => {},
    };
    const model = {
      get: (name: string) => values[name],
      set(name: string, value: unknown) {
        unsaved[name] = value;
        host.change(name, value);
      },
      save_changes() {
        host.saved.push(unsaved);
        unsaved = {};
      },
      on: (event: string, listen: () => void) => (listeners[event] ??= []).push(listen),
      off(event: string, listen: () => void) {
        listeners[event] = (listeners[event] ?? []).filter((one) => one !== listen);
      },
    };
    const source = URL.createObjectURL(new Blob([values._esm as string], { type: "text/javascript" }));
    const { default: front } = await import(source);
    host.end = await front.render({ model, el: document.querySelector("#cell") });
    (window as unknown as { host: Host }).host = host;
  }, widget);
  await swaying(page);

  const wind = page.getByLabel("Wind", { exact: true });
  // what the notebook's third cell has set in Python
  await expect(page.getByText("14.0 m/s")).toBeVisible();
  await expect(page.getByText("90°")).toBeVisible();
  await expect(wind).toHaveValue("");
  await wind.selectOption("Storm front");
  await page.getByLabel("Mean speed").fill("24");
  const saved = await page.evaluate(() => (window as unknown as { host: Host }).host.saved);
  expect(saved.at(-1)).toMatchObject({ wind: { version: 1, model: "navier-stokes", mean_speed_m_s: 24 } });
  await expect(wind).toHaveValue("storm-front");

  await page.evaluate((still) => (window as unknown as { host: Host }).host.change("wind", still), WIND_PRESETS.still);
  await expect(wind).toHaveValue("still");
  await page.evaluate(() => (window as unknown as { host: Host }).host.end());
  await expect(page.locator("canvas")).toHaveCount(0);
});

test("a front end without its files says why there are no trees", async ({ page, quiet }) => {
  const { state } = shown();
  await page.route("http://notebook.test/", (route) =>
    route.fulfill({ contentType: "text/html", body: "<!doctype html><title>cell</title><div id=cell></div>" }),
  );
  await page.goto("http://notebook.test/");
  await page.evaluate(async ({ source, values }) => {
    const { default: front } = await import(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    const empty = new DataView(new ArrayBuffer(8));
    const model = { get: (name: string) => values[name] ?? empty, on() {}, off() {} };
    front.render({ model, el: document.querySelector("#cell") });
  }, { source: state._esm as string, values: { wind: state.wind, trees: 1, height_px: 100 } as Record<string, unknown> });
  await expect(page.getByRole("alert")).toContainText("The trees cannot be shown");
  quiet.length = 0; // the console has it, too
});
