import "uplot/dist/uPlot.min.css";
import "./ui/instruments/instruments.css";
import "./uploads/uploads.css";
import "./risk/risk.css";
import { isAntialiased } from "../scene/quality";
import { loadTrees, openPage } from "./app";
import { connectAbout } from "./controls/about";
import { showHint } from "./controls/hint";
import { showControls } from "./controls/opening";
import { connectSheets } from "./controls/sheets";
import { DataFiles } from "./files/dataFiles";
import { detectGraphics, renewCanvas } from "./forest/graphics";
import { World } from "./forest/world";
import { showNoGraphics } from "./noGraphics";
import { exposeProbe } from "./probe";
import { defaultsFor, LIMITS, type Settings, settingsFromQuery, treesBeyond } from "./settings/settings";
import { sharedFrom } from "./settings/sharedForest";
import { remembered } from "./settings/storedSettings";
import { windFromQuery } from "./settings/windQuery";
import { Store } from "./store/store";
import { element } from "./ui/dom";
import { showToast } from "./ui/toast";
import { whole } from "./ui/words";
import { OwnUploads } from "./uploads/ownUploads";
import { acceptUploads } from "./uploads/upload";

const uploads = new OwnUploads(() => localStorage);
const files = new DataFiles();

/** Reports an invalid wind in the link. */
function checkWind(): void {
  try {
    windFromQuery(location.search);
  } catch (error) {
    showToast("The wind in this link is invalid.", error instanceof Error ? error.message : String(error));
  }
}

/** Says so if the link asks for more trees than are planted. */
function checkTrees(): void {
  const asked = treesBeyond(location.search);
  if (asked === null) return;
  const most = whole(LIMITS.trees.max);
  showToast(
    `This forest has ${most} trees.`,
    `The link asks for ${whole(asked)}; the page plants at most ${most}.`,
  );
}

/** The settings by the address, the storage of this browser and its graphics. */
function openedSettings(software: boolean): { settings: Settings; defaults: Settings } {
  const screen = { width_px: innerWidth, touch: matchMedia("(pointer: coarse)").matches, software };
  const defaults = defaultsFor(screen);
  // Embedded pages and shared views use their address only; otherwise the stored settings apply.
  const own = !/[?&](panel=0|view=|embed)/.test(location.search);
  const usual = own ? remembered(defaults, () => localStorage) : defaults;
  const settings = settingsFromQuery(location.search, usual);
  if (own && sharedFrom(location.search) === null) settings.planted = uploads.plantedWith(settings.planted);
  return { settings, defaults };
}

/** Making the scene occupies the page, so the first tree is being read by its worker before that begins, unless the server takes longer. */
const SERVER_PATIENCE_MS = 400;

/** The first tree loads while the scene is made; which settings the graphics suggest is known after the start. */
async function start(): Promise<void> {
  const { settings, defaults } = openedSettings(false);
  const store = new Store(settings, defaults, location.search);
  const trees = loadTrees(store);
  const view = element<HTMLCanvasElement>("view");
  const graphics = detectGraphics(view);
  if (!graphics.webgl2) {
    trees.dispose();
    showNoGraphics();
    showControls();
    return;
  }
  if (!graphics.software) trees.catalogue.order.loadAll();
  document.body.classList.toggle("graphics-card", !graphics.software);
  const { order } = trees.catalogue;
  await Promise.all([painted(), Promise.race([order.firstArrives, wait(SERVER_PATIENCE_MS)])]);
  const suited = openedSettings(graphics.software);
  store.suit(suited.settings, suited.defaults);
  if (isAntialiased(store.settings.quality)) renewCanvas(view);
  document.body.classList.toggle("bare", !settings.panel);
  document.body.classList.toggle("embedded", settings.embed);
  checkWind();
  checkTrees();
  connectSheets(settings.panel);
  const world = new World(store, trees.client);
  world.stage.shapeLand();
  const page = openPage(store, world, trees.catalogue, uploads, files);
  exposeProbe(page);
  if (settings.panel) showHint(() => localStorage);
  addEventListener("pagehide", (event) => {
    if (!event.persisted) page.world.dispose();
  });
}

/** Settled after the first paint, or after a short timeout if the page is hidden. */
function painted(): Promise<void> {
  return new Promise((done) => {
    requestAnimationFrame(() => setTimeout(done));
    setTimeout(done, 300);
  });
}

const wait = (time_ms: number) => new Promise((done) => setTimeout(done, time_ms));

connectAbout();

// Accept files from the start: otherwise the browser would navigate to a dropped file.
acceptUploads(uploads, files);

void start();
