/** Looks at the graphics in a worker: the first context takes a third of a second, in which the page would stand still. */
import { graphicsOf } from "./graphics";

postMessage(graphicsOf(new OffscreenCanvas(1, 1).getContext("webgl2")));
