/** Starts a worker from a file. Each call names the file itself, in the expression that bundlers look for. */

/** A page may not start a worker of another origin (a CDN), but a worker of its own may import it from there. */
export function startAt(start: () => Worker, file: () => URL): Worker {
  try {
    return start();
  } catch {
    const source = new Blob([`import ${JSON.stringify(file().href)};`], { type: "text/javascript" });
    return new Worker(URL.createObjectURL(source), { type: "module" });
  }
}
