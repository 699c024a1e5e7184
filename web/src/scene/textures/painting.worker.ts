/** Paints the pictures of the ground and its plants, beside the start of the page. */
import { paintLand } from "./landPictures";

const land = paintLand();
postMessage(land, { transfer: Object.values(land).map(({ pixels }) => pixels.buffer) });
