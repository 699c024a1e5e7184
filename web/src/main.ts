import { App } from "./app";
import { detectGraphics } from "./graphics";
import { exposeProbe } from "./probe";
import { defaultsFor, settingsFromQuery } from "./settings";
import { element } from "./ui/dom";

/** The panel starts open where there is room for it. */
function panelToggle(open: boolean): void {
  const panel = element("panel");
  const toggle = element<HTMLButtonElement>("panel-toggle");
  const show = (visible: boolean) => {
    panel.hidden = !visible;
    toggle.setAttribute("aria-expanded", String(visible));
  };
  toggle.addEventListener("click", () => show(panel.hidden === true));
  show(open);
}

function start(software: boolean): void {
  const screen = { width_px: innerWidth, touch: matchMedia("(pointer: coarse)").matches, software };
  const settings = settingsFromQuery(location.search, defaultsFor(screen));
  document.body.classList.toggle("bare", !settings.panel);
  panelToggle(settings.panel && innerWidth > 760);
  const app = new App(settings);
  exposeProbe(app);
  addEventListener("pagehide", (event) => {
    if (!event.persisted) app.dispose();
  });
}

const { webgl2, software } = detectGraphics();
if (webgl2) start(software);
else element("no-webgl").hidden = false;
