/** Starts the graphics driver in a worker: the first context takes a third of a second, in which the page would stand still. */
postMessage(new OffscreenCanvas(1, 1).getContext("webgl2") !== null);
