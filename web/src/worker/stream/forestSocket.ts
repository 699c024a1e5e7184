/** The socket to the server: reconnects automatically, pings, and estimates the server's clock. */
import { decodeReply, encodeRequest, type Reply, type Request } from "../../core/wire/wire";
import { ServerClock } from "./serverClock";

export interface SocketHandlers {
  /** The request to send after every connect. */
  request(): Request;
  reply(reply: Reply): void;
  problem(title: string, hint: string): void;
}

const PING_EVERY_MS = 1000;
/** Short, so that the stream resumes soon after the server returns; meanwhile the local tables move the trees. */
const RETRY_MS = { first: 250, longest: 1000 } as const;
/** A connection without messages for this long is closed. */
const DEAD_MS = 5000;

export class ForestSocket {
  /** True after the connection was lost, until the next message. */
  lost = false;
  latency_ms: number | null = null;
  kB_s = 0;
  readonly clock = new ServerClock();
  private socket: WebSocket | null = null;
  private lastMessage_ms = Number.NaN;
  private bytes = 0;
  private retry_ms: number = RETRY_MS.first;
  private disposed = false;
  private readonly pinging = setInterval(() => this.ping(), PING_EVERY_MS);

  constructor(
    private readonly url: string,
    private readonly handlers: SocketHandlers,
  ) {
    this.connect();
  }

  private connect(): void {
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.send({ type: "hello", client: "galewood-web" });
      this.send(this.handlers.request());
      this.ping();
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.receive(event.data);
    socket.onclose = () => {
      if (this.disposed) return;
      this.lost = true;
      this.lastMessage_ms = Number.NaN;
      setTimeout(() => !this.disposed && this.connect(), this.retry_ms);
      this.retry_ms = Math.min(RETRY_MS.longest, this.retry_ms * 1.7);
    };
  }

  send(request: Request): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(encodeRequest(request));
  }

  /** Called when the requested data arrives. */
  arrived(): void {
    this.lost = false;
    this.retry_ms = RETRY_MS.first;
  }

  private ping(): void {
    if (performance.now() - this.lastMessage_ms > DEAD_MS) this.socket?.close();
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
    } else if (reply.type === "error") this.handlers.problem(reply.title, reply.hint);
    else this.handlers.reply(reply);
  }

  dispose(): void {
    this.disposed = true;
    clearInterval(this.pinging);
    this.socket?.close();
  }
}
