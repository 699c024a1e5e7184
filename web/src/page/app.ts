/** The application: makes the features of the page, and gives each what it depends on. */

import { treeReader } from "../scene/treeModel/treeReader";
import { Capture } from "./camera/capture";
import { Views } from "./camera/views";
import { Comparison } from "./compare/comparison";
import { openControls } from "./controls/opening";
import { connectPause } from "./controls/pause";
import { SceneryBar } from "./controls/scenery";
import { StatusReport } from "./controls/statusReport";
import { fullScreenTool } from "./controls/tools";
import { Undo } from "./controls/undo";
import type { DataFiles } from "./files/dataFiles";
import { ForestClient } from "./forest/forestClient";
import { ForestFigures } from "./forest/forestFigures";
import { FrameLoop, type FramePart } from "./forest/frameLoop";
import { FrameStatistics } from "./forest/frameStatistics";
import { Planting } from "./forest/planting";
import type { World } from "./forest/world";
import { makeGrowthCard } from "./individuals/growthPlaces";
import { Individuals } from "./individuals/individuals";
import { InventoryPlanting } from "./inventory/inventoryPlanting";
import { OwnTreesCard } from "./inventory/ownTreesCard";
import { TreeOverlays } from "./overlays/treeOverlays";
import { PaperMethod } from "./paper/paperMethod";
import { PhysicsCards } from "./physics/physicsCards";
import { PickedCard } from "./picking/pickedCard";
import { TreePicker } from "./picking/treePicker";
import { ProgressCards } from "./progress/progressCards";
import { Gusts } from "./pulling/gusts";
import { Puller } from "./pulling/puller";
import { WindRisk } from "./risk/windRisk";
import { useKeys } from "./server/api";
import { followAttention } from "./server/attention";
import { Catalogue } from "./server/catalogue";
import { loadPart, withServer } from "./server/connected";
import { rememberSettings } from "./settings/storedSettings";
import { showEmbedBar } from "./sharing/embedBar";
import { Sharing } from "./sharing/sharing";
import { WindSound } from "./sound";
import type { Store } from "./store/store";
import { element, makeButton } from "./ui/dom";
import { WindStudio } from "./ui/instruments/windStudio";
import { askForKey, keptKey } from "./ui/keyDialog";
import { OwnTrees } from "./uploads/ownTrees";
import type { OwnUploads } from "./uploads/ownUploads";

/** What `window.galewood` shows of the page. */
export type Page = ReturnType<typeof openPage>;

/** The trees of the server, and the worker that moves them. */
export interface LoadingTrees {
  readonly client: ForestClient;
  readonly catalogue: Catalogue;
  dispose(): void;
}

/** Starts loading the trees, before it is known how they are drawn. */
export function loadTrees(store: Store): LoadingTrees {
  useKeys({ known: keptKey, ask: askForKey });
  treeReader.start();
  const client = new ForestClient(store);
  const catalogue = new Catalogue(store, client);
  return {
    client,
    catalogue,
    dispose() {
      catalogue.dispose();
      client.dispose();
    },
  };
}

export function openPage(
  store: Store,
  world: World,
  catalogue: Catalogue,
  uploads: OwnUploads,
  files: DataFiles,
) {
  const undo = new Undo(store);
  rememberSettings(store);

  // The forest. Subscribers to one value are told in the order in which they are made.
  const paper = new PaperMethod(store, catalogue, world.client);
  const inventory = new InventoryPlanting(store, world);
  const individuals = new Individuals(store, catalogue);
  const growth = individuals.tools;
  inventory.card.append(new OwnTreesCard(store, growth).root);
  makeGrowthCard(store, growth);
  new Planting(store, world, catalogue, paper);

  // What the visitor does with it.
  const views = new Views(store, world);
  const picker = new TreePicker(store, world);
  const puller = new Puller(store, world, picker);
  const gusts = new Gusts(world, picker);
  const studio = new WindStudio(store, world, picker, files);
  const comparison = new Comparison(store, world, catalogue, picker);
  const overlays = new TreeOverlays(world, catalogue, picker, comparison.errors);
  const physics = new PhysicsCards(catalogue);
  const risk = new WindRisk(store, world, picker, views);
  const ownTrees = new OwnTrees(uploads, store, world, catalogue, views);
  const sharing = new Sharing(store, world);
  const sound = new WindSound(store, world);
  const capture = new Capture(store, world);
  files.connect({
    inventory: (found, file) => inventory.open(found, file),
    wind: (wind) => {
      store.settings.wind = wind;
    },
  });

  // Cards, panel and toolbar.
  const retry = () => {
    world.client.retry();
    catalogue.retry();
  };
  followAttention(store.state, retry);
  const meter = new FrameStatistics();
  const status = new StatusReport(store, world, catalogue, meter, retry);
  new SceneryBar(store.settings);
  new ProgressCards(ownTrees, catalogue, world);
  const card = new PickedCard(store, picker, catalogue, paper, {
    menu: overlays.menu.element,
    stem: risk.stemCard.root,
    buttons: [
      makeButton("Check accuracy", () => void comparison.open()),
      makeButton("Physics", () => physics.open()),
    ],
  });
  connectPause(store.playback);
  if (store.settings.embed) showEmbedBar(store.playback, () => sharing.link);
  element("tools").replaceChildren(
    ...undo.tools,
    ...views.tools,
    physics.tool,
    comparison.tool,
    ...sharing.tools,
    sound.tool,
    ...capture.tools,
    fullScreenTool(),
  );

  const parts: FramePart[] = [
    views,
    picker,
    ownTrees,
    puller,
    gusts,
    overlays,
    sound,
    studio,
    capture,
    status,
    card,
  ];
  const loop = new FrameLoop(store, world, catalogue, meter, parts);
  catalogue.onChange(() => loop.report());
  loop.start();
  openControls(store, () => {
    void withServer("The settings are missing.", async () => {
      const { Panel } = await loadPart(() => import("./controls/panel"));
      parts.push(new Panel(store, catalogue, paper, growth, meter.statistics));
    });
  });
  const figures = new ForestFigures(world, catalogue, paper, meter);
  return { store, world, loop, figures, studio, sharing, picker, puller, overlays, sound };
}
