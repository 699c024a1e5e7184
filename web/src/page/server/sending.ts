/** Sends a large body and reports its progress, which fetch does not. */

export interface Sending {
  /** Ends the request; it then fails with an AbortError. */
  readonly signal: AbortSignal;
  /** Share of the body that was sent, 0 to 1. */
  progress(share: number): void;
}

/** As fetch: rejects with a TypeError without a connection and with an AbortError once it was ended. */
export function sendBody(path: string, init: RequestInit, { signal, progress }: Sending): Promise<Response> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const abort = () => request.abort();
    request.open(init.method ?? "POST", path);
    new Headers(init.headers).forEach((value, name) => {
      request.setRequestHeader(name, value);
    });
    request.upload.onprogress = ({ loaded, total }) => progress(total > 0 ? loaded / total : 0);
    request.upload.onload = () => progress(1);
    request.onload = () =>
      resolve(
        new Response(request.responseText, {
          status: request.status,
          headers: { "content-type": request.getResponseHeader("content-type") ?? "" },
        }),
      );
    request.onerror = () => reject(new TypeError("no connection"));
    request.onabort = () => reject(new DOMException("The request was cancelled.", "AbortError"));
    request.onloadend = () => signal.removeEventListener("abort", abort);
    signal.addEventListener("abort", abort);
    if (signal.aborted) reject(new DOMException("The request was cancelled.", "AbortError"));
    else request.send(init.body as XMLHttpRequestBodyInit);
  });
}
