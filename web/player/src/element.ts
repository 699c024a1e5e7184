/**
 * `<galewood-forest src="trees/poplar" trees="12" wind="breeze">`: a small forest for pages without a build step.
 *
 * - `src`: addresses of trees, separated by spaces; each stands for ADDRESS.table and ADDRESS.glb.
 * - `service`: address of a Galewood service instead, whose trees are planted.
 * - `trees`: their number, 1 to 500 (9).
 * - `wind`: a preset (still, breeze, autumn-gusts, storm-front), or a wind document.
 * - `renderer`: of three.js, `webgl` or `webgpu` (webgl). The second draws by WebGL 2 where there is no WebGPU.
 *
 * Where no trees can be shown it says why, in a paragraph and in its attribute `data-error`.
 */
import { PRESETS, parseWindText, type WindDocument } from "./core";
import { Forest, servedTrees } from "./three";
import type { BaseForest } from "./three/baseForest";
import { noGraphics, places, RENDERER_OPTIONS, Stage, type StageRenderer, startWebgl } from "./three/stage";

const MOST_TREES = 500;

function windOf(text: string | null): WindDocument {
  const name = text ?? "breeze";
  return Object.hasOwn(PRESETS, name) ? PRESETS[name as keyof typeof PRESETS] : parseWindText(name);
}

/** A forest and what draws it. */
interface Drawn {
  readonly renderer: StageRenderer;
  readonly forest: BaseForest;
}

const byWebgl = (wind: WindDocument): Drawn => ({ renderer: startWebgl(), forest: new Forest({ wind }) });

/** Loads what WebGPURenderer needs, which pages with the other one do without. */
async function byWebgpu(wind: WindDocument): Promise<Drawn> {
  const [nodes, { WebGPURenderer }] = await Promise.all([import("./webgpu"), import("three/webgpu")]);
  const renderer = new WebGPURenderer(RENDERER_OPTIONS);
  try {
    await renderer.init();
  } catch (cause) {
    throw noGraphics(cause);
  }
  return { renderer, forest: new nodes.Forest({ wind }) };
}

/** Where pages are rendered on a server there are no elements: the module can be imported, and defines none. */
const Base = typeof HTMLElement === "undefined" ? (class {} as typeof HTMLElement) : HTMLElement;

export class GalewoodForest extends Base {
  static readonly observedAttributes = ["wind"];
  /** The forest; null while the element is in no document. */
  forest: BaseForest | null = null;
  /** Ends everything that runs. */
  private end = () => {};
  /** How often it was added to a document or removed. */
  private mounts = 0;

  connectedCallback(): void {
    this.removeAttribute("data-error");
    const mount = ++this.mounts;
    this.begin(mount).catch((error: unknown) => {
      if (mount !== this.mounts) return; // removed from the page meanwhile
      this.stop();
      this.report(error);
      this.show(`The trees cannot be shown: ${error instanceof Error ? error.message : error}`);
    });
  }

  private report(error: unknown): void {
    this.setAttribute("data-error", `${error}`);
    console.error(error);
  }

  private show(reason: string): void {
    const said = document.createElement("p");
    said.setAttribute("role", "alert");
    said.textContent = reason;
    this.append(said);
    this.end = () => said.remove();
  }

  disconnectedCallback(): void {
    this.mounts++;
    this.stop();
  }

  private stop(): void {
    this.end();
    this.end = () => {};
    this.forest = null;
  }

  /** A wind with a mistake is reported, and the wind before goes on. */
  attributeChangedCallback(_name: string, _before: string | null, wind: string | null): void {
    if (!this.forest) return;
    try {
      this.forest.wind = windOf(wind);
      this.removeAttribute("data-error");
    } catch (error) {
      this.report(error);
    }
  }

  private async begin(mount: number): Promise<void> {
    const text = this.getAttribute("wind");
    const wind = windOf(text);
    const asked = this.getAttribute("renderer") ?? "webgl";
    if (asked !== "webgl" && asked !== "webgpu")
      throw new Error(`galewood-forest: renderer is webgl or webgpu, not ${asked}`);
    const { renderer, forest } = asked === "webgl" ? byWebgl(wind) : await byWebgpu(wind);
    const count = Math.min(MOST_TREES, Math.max(1, Number(this.getAttribute("trees") ?? 9) || 1));
    this.style.display ||= "block";
    const stage = new Stage(this, forest, renderer, count);
    if (mount !== this.mounts) {
      stage.end(); // removed from the page while the renderer was loaded
      return;
    }
    this.forest = forest;
    this.end = () => stage.end();
    const now = this.getAttribute("wind"); // it may have changed while the renderer was loaded
    if (now !== text) this.attributeChangedCallback("wind", text, now);
    stage.run(await this.plant(forest, count));
  }

  /** Plants an equal share of each tree; returns the height of the tallest. */
  private async plant(forest: Forest, count: number): Promise<number> {
    const service = this.getAttribute("service");
    const sources = (this.getAttribute("src") ?? "").split(/\s+/).filter((one) => one !== "");
    const trees = service
      ? await servedTrees(service)
      : sources.map((one) => ({ table: `${one}.table`, mesh: `${one}.glb` }));
    if (trees.length === 0)
      throw new Error("galewood-forest: set src to the URL of a tree, without its file extension");
    const all = places(count);
    const planted = await Promise.all(
      trees.map((tree, k) =>
        forest.plant(
          tree,
          all.filter((_, i) => i % trees.length === k),
        ),
      ),
    );
    return Math.max(...planted.map(({ height_m }) => height_m));
  }
}

if (typeof customElements !== "undefined" && !customElements.get("galewood-forest"))
  customElements.define("galewood-forest", GalewoodForest);
