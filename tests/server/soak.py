"""Randomised test of a real server: `python -m tests.server.soak --minutes 10 --seed 1 [--json FILE]`.

Uploads, builds, cancels, deletions, comparisons, evaluations, listeners that come and go and streams that
break off, as the dice fall. At the end nothing may have stuck: the server's memory and open files are flat,
every job has ended, every file is named by something, `galewood doctor` finds no fault, and once all is
deleted the stores are empty.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import psutil
from galewood_server.stream import wire

from tests.server.stream.test_forest_stream import BREEZE, Client
from tests.server.support import sample_meshes
from tests.server.support.server_process import Server, wait_until

SMALL = {"target_tets": 500, "sampled_elements": 5, "frames": 30}
HEIGHTS_M = (2.5, 3.0, 3.5, 4.0)  # few, so that some builds use cached runs
MOST_TREES = 8
LIMITS = {
    "GALEWOOD_REPLACED_FILES_S": "2",
    "GALEWOOD_GARBAGE_COLLECTION_S": "1",
    "GALEWOOD_CLUSTER_IDLE_S": "10",
    "GALEWOOD_READS_PER_MINUTE": "0",
    "GALEWOOD_WRITES_PER_MINUTE": "0",
}
WARM_UP = 0.25
"""Share of the memory samples that are ignored as warm-up."""
GROWTH_BYTES, GROWTH_HANDLES = 48 << 20, 6


class Soak:
    """Random actions on a server and their statistics."""

    def __init__(self, server: Server, seed: int) -> None:
        self.server = server
        self.dice = random.Random(seed)
        self.api = server.client()
        self.done: Counter[str] = Counter()
        self.wrong: list[str] = []
        self.memory: list[int] = []
        self.handles: list[int] = []
        self.kept = ""
        self.listeners: list[threading.Thread] = []

    def begin(self) -> None:
        """One tree has a table before the dice fall, and stays, so that there is something to stream however
        slow the machine is; its first frames load the code that streams.
        """
        file = {"file": ("pole.obj", sample_meshes.pole_obj(2.0))}
        tree = self.ask("POST", "/api/trees", files=file).json()
        self.kept = str(tree["id"])
        self.ask("POST", "/api/jobs", json={"tree_id": self.kept, "settings": SMALL})
        wait_until(lambda: self.ask("GET", f"/api/trees/{self.kept}").json()["state"] == "ready", 1200, 0.5)
        while not self.stream():
            self.wrong.clear()

    def run(self, minutes: float) -> None:
        """Perform random actions until the time is over."""
        actions = {
            self.upload: 3, self.build: 5, self.cancel: 2, self.delete: 2,
            self.compare: 3, self.evaluate: 2, self.listen: 3, self.stream: 3, self.nonsense: 1,
        }  # fmt: skip
        end_s, measured_s = time.monotonic() + 60 * minutes, 0.0
        while time.monotonic() < end_s:
            (action,) = self.dice.choices(list(actions), list(actions.values()))
            self.done[f"{action.__name__}: {action()}"] += 1
            if time.monotonic() - measured_s > 2:
                measured_s = time.monotonic()
                self.measure()
            time.sleep(self.dice.uniform(0, 0.6))

    def measure(self) -> None:
        assert self.server.process
        process = psutil.Process(self.server.process.pid)
        self.memory.append(process.memory_info().rss)
        self.handles.append(process.num_fds())

    def trees(self) -> list[dict[str, Any]]:
        return self.ask("GET", "/api/trees", params={"limit": 500}).json()["trees"]

    def ask(self, method: str, path: str, **more: Any) -> httpx.Response:
        """Send a request; server errors are recorded."""
        answer = self.api.request(method, path, **more)
        if answer.status_code >= 500 and answer.status_code not in (503, 507):
            self.wrong.append(f"{method} {path}: {answer.status_code} {answer.text[:300]}")
        return answer

    def upload(self) -> int:
        trees = self.trees()
        if len(trees) >= MOST_TREES:
            return self.delete()
        file = {"file": ("pole.obj", sample_meshes.pole_obj(self.dice.choice(HEIGHTS_M)))}
        data = {"species": self.dice.choice(["maple", "poplar"]), "name": f"tree {self.dice.random()}"}
        return self.ask("POST", "/api/trees", files=file, data=data).status_code

    def build(self) -> int:
        trees = self.trees()
        if not trees:
            return 0
        tree = self.dice.choice(trees)
        return self.ask("POST", "/api/jobs", json={"tree_id": tree["id"], "settings": SMALL}).status_code

    def cancel(self) -> int:
        jobs = [tree["job_id"] for tree in self.trees() if tree["job_id"]]
        return self.ask("POST", f"/api/jobs/{self.dice.choice(jobs)}/cancel").status_code if jobs else 0

    def delete(self) -> int:
        trees = [tree for tree in self.trees() if tree["id"] != self.kept]
        return self.ask("DELETE", f"/api/trees/{self.dice.choice(trees)['id']}").status_code if trees else 0

    def compare(self) -> int:
        trees = self.trees()
        if not trees:
            return 0
        body = {"wind": BREEZE, "frames": self.dice.choice([30, 300]), "x_m": self.dice.uniform(-50, 50)}
        answer = self.ask("POST", f"/api/trees/{self.dice.choice(trees)['id']}/comparisons", json=body)
        if answer.status_code == 202 and self.dice.random() < 0.4:
            self.ask("POST", answer.headers["location"] + "/cancel")
        return answer.status_code

    def evaluate(self) -> int:
        trees = self.trees()
        if not trees:
            return 0
        body = {"speed_m_s": self.dice.choice([3.0, 5.0]), "frames": 60, "seed": self.dice.randrange(1000)}
        address = f"/api/trees/{self.dice.choice(trees)['id']}/evaluations"
        answer = self.ask("POST", address, json=body)
        if answer.status_code == 202 and self.dice.random() < 0.4:
            self.ask("POST", answer.headers["location"] + "/cancel")
        return answer.status_code

    def listen(self) -> int:
        """Read all events for a while in a separate thread, then disconnect."""
        until_s = time.monotonic() + self.dice.uniform(0.1, 4)

        def follow() -> None:
            with (
                contextlib.suppress(httpx.TransportError),
                self.server.client() as api,
                api.stream("GET", "/api/events", timeout=2) as answer,
            ):
                for _ in answer.iter_lines():
                    if time.monotonic() > until_s:
                        return

        self.listeners = [one for one in self.listeners if one.is_alive()]
        thread = threading.Thread(target=follow)
        thread.start()
        self.listeners.append(thread)
        return len(self.listeners) and 1

    def stream(self) -> int:
        """Request a forest, receive some frames and disconnect without a close."""
        tables = [tree["table_sha256"] for tree in self.trees() if tree["table_sha256"]]
        if not tables:
            return 0
        rows = np.array([[self.dice.uniform(-20, 20), 0, 0, 1] for _ in range(20)], np.float32)
        groups = (wire.Group(self.dice.choice(tables), len(rows)),)
        client = Client(self.server)
        try:
            client.send(wire.Forest("stream", groups, BREEZE, 0.0, None, rows))
            took = sum(1 for _ in zip(range(self.dice.randint(1, 40)), client.frames(), strict=False))
            return took and 1
        except Exception as error:  # the table may have been replaced and removed meanwhile
            return self._excuse(error)
        finally:
            client.socket.close()

    def _excuse(self, error: Exception) -> int:
        if "no-such-table" not in repr(error) and "table" not in str(error):
            self.wrong.append(f"stream: {error!r}")
        return 404

    def nonsense(self) -> int:
        data = self.dice.choice(
            [b"", b"PK\x03\x04", sample_meshes.truncated_glb(), self.dice.randbytes(2000)]
        )
        return self.ask("POST", "/api/trees", files={"file": ("tree.glb", data)}).status_code

    def finish(self) -> None:
        """Cancel active jobs, wait, check the stores, delete everything, and check again."""
        for thread in self.listeners:
            thread.join()
        for tree in self.trees():
            if tree["job_id"]:
                self.ask("POST", f"/api/jobs/{tree['job_id']}/cancel")
            for one in self.ask("GET", f"/api/trees/{tree['id']}/evaluations").json()["evaluations"]:
                self.ask("POST", f"/api/evaluations/{one['id']}/cancel")
        wait_until(lambda: self.api.get("/healthz").json()["jobs_active"] == 0, 300, 0.5)
        time.sleep(3)
        self.measure()
        self.wrong += self._doctor()
        for tree in self.trees():
            self.ask("DELETE", f"/api/trees/{tree['id']}")
        wait_until(lambda: not self._left(), 60, 0.5)
        self.wrong += self._doctor()

    def _left(self) -> list[str]:
        kinds = ("sources", "meshes", "tables", "models", "pictures", "results")
        folder = self.server.data_dir
        return [str(path) for kind in kinds for path in (folder / kind).rglob("*") if path.is_file()]

    def _doctor(self) -> list[str]:
        command = [sys.executable, "-m", "galewood_server.cli.main", "doctor"]
        answer = subprocess.run(command, env=self.server.variables(), capture_output=True, text=True)
        return [] if answer.returncode == 0 else [f"doctor: {answer.stdout} {answer.stderr}"]

    def verdict(self) -> dict[str, Any]:
        """Statistics and a list of failures, which is empty if the test passed."""
        memory, handles = flat(self.memory), flat(self.handles)
        if memory["growth"] > GROWTH_BYTES:
            self.wrong.append(f"memory grew by {memory['growth'] >> 20} MB")
        if handles["growth"] > GROWTH_HANDLES:
            self.wrong.append(f"{handles['growth']} more files are open")
        if not (self.done["stream: 1"] and self.done["compare: 202"]):
            self.wrong.append("nothing was streamed or compared")
        if "Traceback" in self.server.log():
            self.wrong.append("the log holds a traceback:\n" + self.server.log()[-3000:])
        return {"done": dict(self.done), "memory_bytes": memory, "handles": handles, "wrong": self.wrong}


def flat(values: list[int]) -> dict[str, int]:
    """Early and late medians after the warm-up, and their difference."""
    kept = values[int(WARM_UP * len(values)) :]
    third = max(1, len(kept) // 3)
    early, late = int(np.median(kept[:third])), int(np.median(kept[-third:]))
    return {"early": early, "late": late, "growth": late - early, "largest": max(values)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    with tempfile.TemporaryDirectory(prefix="galewood-soak-") as folder:
        data_dir = Path(folder) / "data"
        data_dir.mkdir()
        server = Server(data_dir, "galewood_server.cli.main", LIMITS).start("serve")
        try:
            soak = Soak(server, options.seed)
            soak.begin()
            soak.run(options.minutes)
            soak.finish()
            verdict = soak.verdict()
        finally:
            server.stop()
    print(json.dumps(verdict, indent=2))
    if options.json:
        options.json.write_text(json.dumps(verdict, indent=2) + "\n")
    return 1 if verdict["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
