/** What is shown instead of the forest where the browser has no WebGL 2: why, what to do, and a film. */
import film from "../../../docs/images/storm.webp";
import { element, make } from "./ui/dom";

const REASON_WORDS =
  "The forest is drawn by the graphics hardware, through WebGL 2, which this browser does not offer. Turn on hardware " +
  "acceleration in its settings, update it, or open this page in a current Firefox, Chrome, Edge or Safari.";
const FILM_WORDS =
  "This is what it looks like: three seconds of a storm, in which every tree sways on its own.";

export function showNoGraphics(): void {
  const card = make("section", "", "no-webgl");
  const title = make("h2", "This browser cannot draw the forest");
  title.id = "no-webgl-heading";
  card.setAttribute("aria-labelledby", title.id);
  const picture = make("img");
  Object.assign(picture, { src: film, alt: "A forest sways in a storm" });
  card.append(title, make("p", REASON_WORDS), picture, make("p", FILM_WORDS));
  element("stage").replaceChildren(card);
  document.body.classList.add("without-forest");
}
