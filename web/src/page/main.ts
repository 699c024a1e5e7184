import "./ui/instruments/instruments.css";
import { App } from "./app";
import { detectGraphics } from "./graphics";
import { exposeProbe } from "./probe";
import { defaultsFor, settingsFromQuery } from "./settings/settings";
import { remembered } from "./settings/storedSettings";
import { windFromQuery } from "./settings/windQuery";
import { element } from "./ui/dom";
import { showToast } from "./ui/toast";
import { acceptUploads } from "./ui/upload";

/** A panel starts open where there is room for it. */
function panelToggle(id: string, open: boolean): void {
  const panel = element(id);
  const toggle = element<HTMLButtonElement>(`${id}-toggle`);
  const show = (visible: boolean) => {
    panel.hidden = !visible;
    toggle.setAttribute("aria-expanded", String(visible));
  };
  toggle.addEventListener("click", () => show(panel.hidden === true));
  show(open);
}

/** Says so if the link has a wind that cannot be used. */
function checkWind(): void {
  try {
    windFromQuery(location.search);
  } catch (error) {
    showToast(
      "The wind of this link cannot be used.",
      error instanceof Error ? error.message : String(error),
    );
  }
}

function start(software: boolean): void {
  const screen = { width_px: innerWidth, touch: matchMedia("(pointer: coarse)").matches, software };
  const defaults = defaultsFor(screen);
  // Embedded pages and shared views use their address only; otherwise the stored settings apply.
  const own = !/[?&](panel=0|view=)/.test(location.search);
  const usual = own ? remembered(defaults, () => localStorage) : defaults;
  const settings = settingsFromQuery(location.search, usual);
  document.body.classList.toggle("bare", !settings.panel);
  checkWind();
  panelToggle("panel", false);
  panelToggle("instruments", settings.panel && innerWidth > 760);
  panelToggle("tools", innerWidth > 760);
  const app = new App(settings, defaults);
  exposeProbe(app);
  addEventListener("pagehide", (event) => {
    if (!event.persisted) app.dispose();
  });
}

/** Calls back after the first paint, or after a moment in a hidden page. */
function afterPaint(then: () => void): void {
  let called = false;
  const once = () => {
    if (!called) then();
    called = true;
  };
  requestAnimationFrame(() => setTimeout(once));
  setTimeout(once, 300);
}

// Files are accepted from the start: the browser would otherwise open a dropped file in place of the page.
const stopUploads = acceptUploads();
addEventListener("pagehide", ({ persisted }) => {
  if (!persisted) stopUploads();
});

// The text is painted first: starting the forest takes a moment, and long without a GPU.
afterPaint(() => {
  const graphics = detectGraphics();
  if (graphics.webgl2) start(graphics.software);
  else element("no-webgl").hidden = false;
});
