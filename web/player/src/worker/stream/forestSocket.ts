/** The socket to the server: reconnects automatically, pings, and estimates the server's clock. */
import { Backoff } from "../../core/net/backoff";
import { decodeReply, encodeRequest, type Reply, type Request } from "../../core/wire/wire";
import { ServerClock } from "./serverClock";

export interface SocketHandlers {
  /** The request to send after every connect. */
  request(): Request;
  /** Called after the request was sent. */
  opened?(): void;
  reply(reply: Reply): void;
  /** `code`: of an error of the server. */
  problem(title: string, hint: string, code?: string): void;
}

const PING_EVERY_MS = 1000;
/** A connection without messages for this long is closed. */
const DEAD_MS = 5000;
/** Until the requested data arrive, because the server answers nothing while it loads the tables of a forest. */
const DEAD_AT_FIRST_MS = 20_000;
/** So is one that is not established after this long. */
const CONNECTED_WITHIN_MS = 10_000;

export class ForestSocket {
  /** True after the connection was lost or the request refused, until the requested data arrive. */
  lost = false;
  latency_ms: number | null = null;
  kB_s = 0;
  readonly clock = new ServerClock();
  private socket: WebSocket | null = null;
  private lastMessage_ms = Number.NaN;
  private begun_ms = Number.NaN;
  private bytes = 0;
  private readonly backoff = new Backoff();
  private waiting: ReturnType<typeof setTimeout> | null = null;
  private suspended = false;
  /** Whether the forest is too large for the server: asking again would be in vain, and costs up to 16 bytes a tree. */
  private refused = false;
  /** Whether the requested data have arrived over this connection. */
  private answered = false;
  private disposed = false;
  private readonly pinging = setInterval(() => this.ping(), PING_EVERY_MS);

  constructor(
    private readonly url: string,
    private readonly handlers: SocketHandlers,
  ) {
    this.connect();
  }

  private connect(): void {
    this.waiting = null;
    if (this.disposed || this.suspended) return;
    const socket = new WebSocket(this.url);
    this.socket = socket;
    this.begun_ms = performance.now();
    this.answered = false;
    this.refused = false;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.send({ type: "hello", client: "galewood-web" });
      this.send(this.handlers.request());
      this.handlers.opened?.();
      this.ping();
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.receive(event.data);
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      this.lastMessage_ms = Number.NaN;
      if (this.disposed || this.suspended) return;
      this.lost = true;
      if (this.refused) return;
      this.waiting = setTimeout(() => this.connect(), this.backoff.next_ms());
    };
  }

  /** Tries to connect at once if the connection is lost, for example because the network is back. */
  retry(): void {
    if (this.waiting === null) return;
    clearTimeout(this.waiting);
    this.backoff.reset();
    this.connect();
  }

  /** Closes the connection until it is wanted again. */
  suspend(suspended: boolean): void {
    if (suspended === this.suspended) return;
    this.suspended = suspended;
    if (suspended) this.socket?.close();
    else {
      this.backoff.reset();
      if (this.waiting !== null) clearTimeout(this.waiting);
      this.socket = null; // it may still be closing
      this.connect();
    }
  }

  send(request: Request): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(encodeRequest(request));
  }

  /** Called when the requested data arrives. */
  arrived(): void {
    this.lost = false;
    this.answered = true;
    this.backoff.reset();
  }

  private ping(): void {
    const now_ms = performance.now();
    const unconnected = this.socket?.readyState === WebSocket.CONNECTING;
    const patience_ms = this.answered ? DEAD_MS : DEAD_AT_FIRST_MS;
    if (now_ms - this.lastMessage_ms > patience_ms) this.socket?.close();
    else if (unconnected && now_ms - this.begun_ms > CONNECTED_WITHIN_MS) this.socket?.close();
    this.send({ type: "ping", t: performance.now() });
    this.kB_s = this.bytes / PING_EVERY_MS;
    this.bytes = 0;
  }

  private receive(data: ArrayBuffer): void {
    this.bytes += data.byteLength;
    this.lastMessage_ms = performance.now();
    let reply: Reply;
    try {
      reply = decodeReply(data);
    } catch (error) {
      this.handlers.problem(
        "The server's stream could not be decoded.",
        error instanceof Error ? error.message : String(error),
      );
      this.socket?.close();
      return;
    }
    if (reply.type === "pong") {
      this.latency_ms = performance.now() - reply.t;
      this.clock.pong(reply.t, performance.now(), reply.server_s);
    } else if (reply.type === "error") {
      // The request was refused, for example because the forest has too many trees: nothing will arrive.
      if (!this.answered) this.lost = true;
      this.refused = reply.code === "too-many-trees";
      this.handlers.problem(reply.title, reply.hint, reply.code);
    } else this.handlers.reply(reply);
  }

  dispose(): void {
    this.disposed = true;
    clearInterval(this.pinging);
    if (this.waiting !== null) clearTimeout(this.waiting);
    this.socket?.close();
  }
}
