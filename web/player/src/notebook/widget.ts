/** The front end of a notebook's widget (anywidget): a small forest below a cell. Everything it needs is in its one file. */

import workerSource from "virtual:worker";
import { parseWind, type WindDocument } from "../core/wind/document";
import { Forest } from "../three/forest";
import { places, Stage, startWebgl } from "../three/stage";
import { WindControls } from "./windControls";

/** The part of anywidget's model that is needed; precompute/galewood/io/notebook/widget.py is its other side. */
export interface Model {
  get(name: "table" | "mesh"): DataView;
  get(name: "trees" | "height_px"): number;
  get(name: "wind"): unknown;
  set(name: "wind", wind: WindDocument): void;
  save_changes(): void;
  on(event: "change:wind" | "change:height_px", listener: () => void): void;
  off(event: "change:wind" | "change:height_px", listener: () => void): void;
}

const bytesOf = ({ buffer, byteOffset, byteLength }: DataView): ArrayBuffer =>
  (buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength);

/** A front end may run where no further file can be fetched. */
function startWorker(): Worker {
  const url = URL.createObjectURL(new Blob([workerSource], { type: "text/javascript" }));
  return new Worker(url, { type: "module" });
}

/** Shows the forest and the controls of its wind; returns what ends it. */
function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const picture = document.createElement("div");
  picture.style.height = `${model.get("height_px")}px`;
  el.append(picture);
  let end = () => {};
  try {
    end = begin(model, el, picture);
  } catch (error) {
    complain(el, error);
  }
  return () => {
    end();
    el.replaceChildren();
  };
}

function begin(model: Model, el: HTMLElement, picture: HTMLElement): () => void {
  const forest = new Forest({ wind: parseWind(model.get("wind")), worker: startWorker });
  const stage = staged(picture, forest, model.get("trees"));
  const controls = new WindControls(parseWind(model.get("wind")), (wind) => {
    forest.wind = wind;
    model.set("wind", wind);
    model.save_changes();
  });
  el.append(controls.element);
  const changed = () => {
    const wind = parseWind(model.get("wind"));
    forest.wind = wind;
    controls.show(wind);
  };
  const resized = () => {
    picture.style.height = `${model.get("height_px")}px`;
  };
  model.on("change:wind", changed);
  model.on("change:height_px", resized);
  let ended = false;
  const files = { table: bytesOf(model.get("table")), mesh: bytesOf(model.get("mesh")) };
  forest.plant(files, places(model.get("trees"))).then(
    ({ height_m }) => stage.run(height_m),
    (error: unknown) => {
      if (!ended) complain(el, error);
    },
  );
  return () => {
    ended = true;
    model.off("change:wind", changed);
    model.off("change:height_px", resized);
    stage.end();
  };
}

/** Where there is no WebGL the forest's worker must not stay. */
function staged(picture: HTMLElement, forest: Forest, trees: number): Stage {
  try {
    return new Stage(picture, forest, startWebgl(), trees);
  } catch (error) {
    forest.dispose();
    throw error;
  }
}

/** Says below the cell why there are no trees. */
function complain(el: HTMLElement, error: unknown): void {
  const line = document.createElement("p");
  line.setAttribute("role", "alert");
  line.textContent = `The trees cannot be shown: ${error instanceof Error ? error.message : error}`;
  el.replaceChildren(line);
  console.error(error);
}

export default { render };
