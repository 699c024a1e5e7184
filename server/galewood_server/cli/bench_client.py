"""Lightweight stream clients in one process, for benchmarks of the server.

`python -m galewood_server.cli.bench_client` reads a JSON line with its parameters from standard input,
prints "ready", measures for the number of seconds given by each further line, and finally prints the
results as JSON.
Server and clients must run on the same machine, because they compare times of its clock.
"""

from __future__ import annotations

import json
import os
import select
import socket
import sys
import time
from typing import Any

import numpy as np
from galewood.constants import WIRE_FRAME

from galewood_server.stream import wire

BYTES_PER_TREE = 256
_HANDSHAKE = (
    b"GET /ws/forest HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: Z2FsZXdvb2QtYmVuY2gtMQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)


def masked(message: bytes, opcode: int = 2) -> bytes:
    """The WebSocket frame of a client message, with a zero mask."""
    head = bytes([0x80 | opcode])
    if len(message) < 126:
        head += bytes([0x80 | len(message)])
    elif len(message) < 65536:
        head += b"\xfe" + len(message).to_bytes(2)
    else:
        head += b"\xff" + len(message).to_bytes(8)
    return head + bytes(4) + message


def client_forest(job: dict[str, Any], member: int) -> wire.Forest:
    """The forest request of client number `member`: shared or private."""
    tables, count = job["tables"], job["trees"]
    counts = [count // len(tables) + (k < count % len(tables)) for k in range(len(tables))]
    own = job["forests"] == 0
    rng = np.random.default_rng(member if own else member % job["forests"])
    trees = rng.uniform([-120, -120, -np.pi, 0.8], [120, 120, np.pi, 1.25], (count, 4)).astype(np.float32)
    groups = tuple(wire.Group(table, n) for table, n in zip(tables, counts, strict=True))
    share = None if own else f"bench-{member % job['forests']}"
    return wire.Forest("stream", groups, job["wind"], 0.0, None, trees, job["method"], share)


def connected(port: int, forest: wire.Forest) -> socket.socket:
    """Open a WebSocket and request a forest. ConnectionError."""
    link = socket.create_connection(("127.0.0.1", port))
    link.sendall(_HANDSHAKE)
    answer = b""
    while b"\r\n\r\n" not in answer:
        piece = link.recv(1)
        if not piece:
            raise ConnectionError("the server closed the socket")
        answer += piece
    if b" 101 " not in answer[:20]:
        raise ConnectionError(answer.split(b"\r\n")[0].decode())
    link.sendall(masked(wire.encode_request(wire.Hello("bench"))))
    link.sendall(masked(wire.encode_request(forest)))
    return link


class Listener:
    """One client: counts received frames and checks the base ticks of differences."""

    def __init__(self, link: socket.socket, trees: int) -> None:
        self.link = link
        self.ages_s: list[float] = []
        self.received_bytes = 0
        self.keys = self.base_mismatches = 0
        self.tick: int | None = None
        self._buffer = bytearray((1 << 18) + BYTES_PER_TREE * trees)
        self._view = memoryview(self._buffer)
        self._filled = 0
        link.setblocking(False)

    def reset_counts(self) -> None:
        """Reset the counters."""
        self.ages_s, self.received_bytes, self.keys, self.base_mismatches = [], 0, 0, 0

    def read(self) -> bool:
        """Read available data; False at the end of the stream."""
        try:
            count = self.link.recv_into(self._view[self._filled :])
        except BlockingIOError:
            return True
        except ConnectionError:
            return False
        now_s = time.monotonic()
        self._filled += count
        self.received_bytes += count
        at = self._take_frames(now_s)
        if at:
            rest = self._filled - at
            self._buffer[:rest] = self._buffer[at : self._filled]
            self._filled = rest
        return count > 0

    def _take_frames(self, now_s: float) -> int:
        at = 0
        while at + 2 <= self._filled:
            opcode, length, start = self._buffer[at] & 15, self._buffer[at + 1] & 127, at + 2
            if length > 125:
                wide = 2 if length == 126 else 8
                if start + wide > self._filled:
                    break
                length, start = int.from_bytes(self._buffer[start : start + wide]), start + wide
            if start + length > self._filled:
                break
            self._take(opcode, start, length, now_s)
            at = start + length
        return at

    def _take(self, opcode: int, start: int, length: int, now_s: float) -> None:
        if opcode == 9:
            self.link.send(masked(bytes(self._view[start : start + length]), 10))
        elif opcode == 2:
            kind, header, _ = wire.decode_message(self._view[start : start + length])
            if kind != WIRE_FRAME:
                return
            self.ages_s.append(now_s - header["made_s"])
            self.keys += header["base"] is None
            self.base_mismatches += header["base"] not in (None, self.tick)
            self.tick = header["tick"]


def listen(listeners: list[Listener], until_s: float) -> int:
    """Read until a time. Returns the number of clients that were disconnected."""
    poll = select.epoll()
    by_number = {listener.link.fileno(): listener for listener in listeners}
    for number in by_number:
        poll.register(number, select.EPOLLIN)
    lost = 0
    while (left_s := until_s - time.monotonic()) > 0:
        for number, _ in poll.poll(left_s):
            if not by_number[number].read():
                poll.unregister(number)
                lost += 1
    poll.close()
    return lost


def wait_until_cut(links: list[socket.socket], until_s: float) -> list[float]:
    """Keep sockets open without reading. Returns the times at which the server closed them."""
    poll = select.poll()
    for link in links:
        poll.register(link.fileno(), 0)  # only errors and hang-ups
    cut: list[float] = []
    while len(cut) < len(links) and (left_s := until_s - time.monotonic()) > 0:
        for number, _ in poll.poll(1e3 * left_s):
            poll.unregister(number)
            cut.append(time.monotonic())
    return cut


def figures(listeners: list[Listener], seconds: float, lost: int, spent_s: float) -> dict[str, Any]:
    """Results over all clients."""
    ages_ms = 1e3 * np.array([age for listener in listeners for age in listener.ages_s] or [np.nan])
    rates_hz = [len(listener.ages_s) / seconds for listener in listeners]
    return {
        "frames_hz": {"mean": float(np.mean(rates_hz)), "slowest_client": min(rates_hz)},
        "age_ms": {f"p{q:g}": float(np.percentile(ages_ms, q)) for q in (50, 90, 99, 99.9, 100)},
        "megabytes_per_s": sum(listener.received_bytes for listener in listeners) / seconds / 1e6,
        "key_frames": sum(listener.keys for listener in listeners),
        "base_mismatches": sum(listener.base_mismatches for listener in listeners),
        "lost_clients": lost,
        "clients_cpu_share": spent_s / seconds,
    }


def main() -> None:
    """Run the benchmark clients (see the module docstring)."""
    job: dict[str, Any] = json.loads(sys.stdin.readline())
    if job["core"] is not None:
        os.sched_setaffinity(0, {job["core"]})
    begin_s = time.monotonic()
    if job["stalled"]:
        links = [connected(job["port"], client_forest(job, member)) for member in range(job["clients"])]
        print("ready", flush=True)
        cut = wait_until_cut(links, begin_s + job["seconds"])
        result: dict[str, Any] = {"cut": len(cut), "last_cut_after_s": max(cut) - begin_s if cut else None}
    else:
        listeners = _listeners(job)
        _wait_for_frames(listeners)
        listen(listeners, time.monotonic() + job["settle_s"])
        print("ready", flush=True)
        result = {"phases": _phases(listeners)}
    print(json.dumps(result), flush=True)


def _listeners(job: dict[str, Any]) -> list[Listener]:
    """Connect all clients; connected ones read meanwhile."""
    listeners: list[Listener] = []
    for member in range(job["clients"]):
        listeners.append(Listener(connected(job["port"], client_forest(job, member)), job["trees"]))
        if member % 8 == 7:
            listen(listeners, time.monotonic() + 0.05)
    return listeners


def _wait_for_frames(listeners: list[Listener], patience_s: float = 180.0) -> None:
    """Wait for the first frame of every client; numba may have to compile first."""
    end_s = time.monotonic() + patience_s
    while any(listener.tick is None for listener in listeners):
        if listen(listeners, time.monotonic() + 0.5) or time.monotonic() > end_s:
            raise RuntimeError("some clients receive no frames: see the server log")


def _next_line(listeners: list[Listener]) -> str:
    """The next line of standard input. Clients keep reading meanwhile, so that no old frames queue up."""
    while not select.select([sys.stdin], [], [], 0)[0]:
        listen(listeners, time.monotonic() + 0.05)
    return sys.stdin.readline()


def _phases(listeners: list[Listener]) -> list[dict[str, Any]]:
    """One measurement per line of standard input, which gives its length in seconds."""
    phases: list[dict[str, Any]] = []
    while line := _next_line(listeners):
        for listener in listeners:
            listener.reset_counts()
        seconds, spent_s = float(line), time.process_time()
        lost = listen(listeners, time.monotonic() + seconds)
        phases.append(figures(listeners, seconds, lost, time.process_time() - spent_s))
        print("measured", flush=True)
    return phases


if __name__ == "__main__":
    main()
