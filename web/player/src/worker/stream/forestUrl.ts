/** The address of the socket. Pure. */
import type { ShareRequest } from "../protocol";

/**
 * The socket's address with the shared forest in its query: a proxy before several servers sends all clients of a forest
 * to the same one by it. The server itself takes the forest from the request.
 */
export function forestUrl(socketUrl: string, share: ShareRequest | null): string {
  if (share === null) return socketUrl;
  const url = new URL(socketUrl);
  url.searchParams.set("share", share.id);
  return url.href;
}
