/** The panels that buttons open and close. Where they would not fit side by side, opening one closes the others. */
import { element, PHONE_PAGE } from "../ui/dom";

const NAMES = ["instruments", "tools", "panel"] as const;
type Name = (typeof NAMES)[number];

/** Narrow pages show tools or settings, phones also the instruments instead of them. */
const narrow = matchMedia("(max-width: 1099px)");
const phone = matchMedia(PHONE_PAGE);

const toggleOf = (name: Name) => element<HTMLButtonElement>(`${name}-toggle`);

function show(name: Name, visible: boolean): void {
  element(name).hidden = !visible;
  toggleOf(name).setAttribute("aria-expanded", String(visible));
}

/** Closes what has no room beside an open panel. */
function makeRoomFor(name: Name): void {
  const rivals = NAMES.filter((other) => other !== name && (phone.matches || other !== "instruments"));
  if (narrow.matches && (phone.matches || name !== "instruments"))
    for (const other of rivals) show(other, false);
}

/** The wide page always shows its toolbar. */
function fitPanels(): void {
  if (!narrow.matches) show("tools", true);
  const open = NAMES.filter((name) => !element(name).hidden);
  if (narrow.matches && open.includes("tools")) show("tools", false);
  if (phone.matches) for (const name of open.slice(1)) show(name, false);
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
  show("instruments", instruments && !phone.matches);
  show("tools", true);
  fitPanels();
  for (const width of [narrow, phone]) width.addEventListener("change", fitPanels);
}
