/** The panels that buttons open and close. Where they would not fit side by side, opening one closes the others. */
import { element } from "../ui/dom";

const NAMES = ["instruments", "tools", "panel"] as const;
type Name = (typeof NAMES)[number];

/** Narrow pages show tools or settings, phones also the instruments instead of them. */
const NARROW_PAGE = matchMedia("(max-width: 1099px)");
const PHONE_PAGE = matchMedia("(max-width: 760px)");

const toggleOf = (name: Name) => element<HTMLButtonElement>(`${name}-toggle`);

function show(name: Name, visible: boolean): void {
  element(name).hidden = !visible;
  toggleOf(name).setAttribute("aria-expanded", String(visible));
}

/** Closes what has no room beside an open panel. */
function makeRoomFor(name: Name): void {
  const rivals = NAMES.filter((other) => other !== name && (PHONE_PAGE.matches || other !== "instruments"));
  if (NARROW_PAGE.matches && (PHONE_PAGE.matches || name !== "instruments"))
    for (const other of rivals) show(other, false);
}

/** The wide page always shows its toolbar. */
function fitPanels(): void {
  if (!NARROW_PAGE.matches) show("tools", true);
  const open = NAMES.filter((name) => !element(name).hidden);
  if (NARROW_PAGE.matches && open.includes("tools")) show("tools", false);
  if (PHONE_PAGE.matches) for (const name of open.slice(1)) show(name, false);
}

/** Connects the panels with their buttons. */
export function connectSheets(instruments: boolean): void {
  for (const name of NAMES) {
    toggleOf(name).addEventListener("click", () => {
      const opens = element(name).hidden === true;
      show(name, opens);
      if (opens) makeRoomFor(name);
    });
  }
  show("panel", false);
  show("instruments", instruments && !PHONE_PAGE.matches);
  show("tools", true);
  fitPanels();
  for (const width of [NARROW_PAGE, PHONE_PAGE]) width.addEventListener("change", fitPanels);
}
