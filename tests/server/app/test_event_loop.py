"""No request, however large, keeps the event loop or the interpreter: all streams would wait for it."""

from __future__ import annotations

import json
import struct
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from galewood_server.storage import Tree, open_database

from tests.server.api.test_structures import NAME, species_folder
from tests.server.support.sample_meshes import pole_obj
from tests.server.support.server_process import FAKE_JOB, NO_CLUSTER, Server
from tests.server.support.untrusted_meshes import glb

LONGEST_MS = 20.0
"""Frames of a stream are 33 ms apart."""
TRIES = 3
UPLOAD_BYTES = 64 << 20
BODY_BYTES = 64 << 10
TREES = 600
HEADERS = {
    "if-none-match": ", ".join(['"none"'] * 2000),
    "accept-encoding": ", ".join(["x;q=0.5"] * 2000) + ", gzip",
}
FORM = {"content-type": "multipart/form-data; boundary=x"}
Requests = list[dict[str, Any]]
"""Keyword arguments of `httpx.Client.build_request` besides method and address."""


@dataclass(frozen=True)
class Names:
    """What the server has, for the parameters of paths."""

    tree_id: str
    job_id: str
    sha256: dict[str, str]

    def path(self, template: str) -> str:
        """An address with the names of things that exist, where there are such."""
        kind = template.split("/")[2] if template.count("/") > 1 else ""
        given = {
            "tree_id": self.tree_id, "job_id": self.job_id, "name": "skeleton.png", "kind": "pivots",
            "comparison_id": "none", "evaluation_id": "none", "sha256": self.sha256.get(kind, "0" * 64),
            "file": "none.webp",
        }  # fmt: skip
        return template.format(**given)


def form(content: bytes, filename: str, fields: bytes = b"") -> dict[str, Any]:
    head = f'--x\r\nContent-Disposition: form-data; name="file"; filename="{filename}"\r\n\r\n'.encode()
    return {"content": fields + head + content + b"\r\n--x--\r\n", "headers": FORM}


def filled(head: bytes, line: bytes, size: int = UPLOAD_BYTES - 1000) -> bytes:
    """A text of almost the largest size: a beginning and many equal lines."""
    return head + line * ((size - len(head)) // len(line))


def uploads() -> Requests:
    """The largest uploads of each format, and forms that are slow to read."""
    scene: dict[str, object] = {"asset": {"version": "2.0"}, "accessors": [{"count": 3}] * 200_000}
    wide = b"".join(
        b'--x\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n' % (name, b"a," * 500_000)
        for name in (b"wood_parts", b"leaves", b"drop")
    )
    triangle = b"v 0 9 %d\nv 1 9 %d\nv 0 10 %d\nf -1 -2 -3\n"
    parts = b"".join(b"g " + b"n" * 4000 + b"%d\n" % k + triangle % (k, k, k) for k in range(1000))
    return [
        form(filled(b"v 0 0 0\n", b"f \n"), "faces.obj"),
        form(filled(b"ply\n", b" "), "blank.ply"),
        form(glb(scene), "scene.glb"),
        form(struct.pack("<80sI", b"", 1_300_000) + bytes(50 * 1_300_000), "a.stl"),
        form(filled(b"", b"\r\n--x-"), "delimiters.obj"),
        form(filled(b"", b"\r"), "returns.obj"),
        form(b"v 0 0 0\n", "fields.obj", wide),
        form(pole_obj() + parts, "parts.obj"),
    ]


def bodies(**fields: Any) -> Requests:
    """Largest bodies of JSON: long lists, deep ones, long texts; `fields` are what the route needs."""
    names = ["a"] * ((BODY_BYTES - 1000) // 5)
    deep = b'{"a":' + b"[" * (BODY_BYTES - 10)
    return [
        {"json": {**fields, "wood_parts": names}},
        {"json": {**fields, "settings": {"leaves": names}}},
        {"json": {**fields, "name": "a" * (BODY_BYTES - 1000)}},
        {"content": deep, "headers": {"content-type": "application/json"}},
    ]


def winds() -> Requests:
    """Largest wind documents."""
    gust = {"from_s": 0.0, "to_s": 1.0}
    return [
        *bodies(),
        {"json": {"version": 1, "model": "spectral", "gusts": [gust] * (BODY_BYTES // 40)}},
        {"json": {"version": 1, **{f"field-{k}": 1 for k in range(3500)}}},
    ]


def largest_inputs() -> dict[str, Requests]:
    """The largest requests of every operation of the API. A new operation needs its largest input here."""
    plain: Requests = [{"headers": HEADERS}]
    page: Requests = [{"headers": HEADERS, "params": {"limit": 500}}]
    file: Requests = [*plain, {"headers": {"range": "bytes=" + ",".join(["0-10"] * 16)}}, {}]
    wind = {"wind": {"version": 1}}
    return {
        "POST /api/trees": uploads(),
        "POST /api/individuals": [*bodies(), {"json": {"species": "oak", "seed": 1, "height_m": 14}}],
        "POST /api/individuals/find": [
            *bodies(),
            {"json": {"individuals": [{"species": "oak", "seed": k, "height_m": 14} for k in range(64)]}},
        ],
        "GET /api/trees": page,
        "GET /api/trees/{tree_id}": plain,
        "PATCH /api/trees/{tree_id}": bodies(),
        "POST /api/trees/{tree_id}/pieces": [{}],
        "POST /api/trees/{tree_id}/copies": bodies(),
        "GET /api/trees/{tree_id}/thumbnail": plain,
        "GET /api/trees/{tree_id}/structure": plain,
        "GET /api/trees/{tree_id}/strain": [*plain, {"params": {"speed_m_s": 1}}],
        "GET /api/trees/{tree_id}/exports/{kind}": [
            {"params": {"seconds": 1, "fps": 5}}, {"params": {"wind": "[" * 4000}},
        ],
        "GET /api/jobs": page,
        "POST /api/jobs": bodies(tree_id=NAME),
        "POST /api/jobs/{job_id}/retry": plain,
        "GET /api/jobs/{job_id}": plain,
        "POST /api/jobs/{job_id}/cancel": plain,
        "GET /api/jobs/{job_id}/pictures/{name}": plain,
        "POST /api/trees/{tree_id}/comparisons": [*bodies(**wind), {"json": {"wind": winds()[-1]["json"]}}],
        "GET /api/comparisons/{comparison_id}": plain,
        "POST /api/comparisons/{comparison_id}/cancel": plain,
        "GET /api/comparisons/{comparison_id}/events": plain,
        "GET /api/comparisons/{comparison_id}/tracks": plain,
        "POST /api/trees/{tree_id}/evaluations": bodies(),
        "GET /api/trees/{tree_id}/evaluations": plain,
        "GET /api/evaluations/{evaluation_id}": plain,
        "POST /api/evaluations/{evaluation_id}/cancel": plain,
        "GET /api/evaluations/{evaluation_id}/events": plain,
        "GET /api/evaluations/{evaluation_id}/report": plain,
        "GET /api/evaluations/{evaluation_id}/plot": plain,
        "GET /api/tables": page,
        "GET /api/tables/{sha256}/metadata": plain,
        "GET /api/tables/{sha256}": file,
        "GET /api/records/{sha256}": file,
        "GET /api/compliances/{sha256}": file,
        "GET /api/meshes/{sha256}": file,
        "GET /api/light-meshes/{sha256}": file,
        "GET /api/light-meshes/pictures/{file}": file,
        "GET /api/species": plain,
        "POST /api/winds/validate": winds(),
        "POST /api/convert": [
            {"content": filled(b'"', b"a" * 1000)},
            {"content": filled(b"x,y,height\n", b"1,2,9\n", 20_000 * 6)},
            {"content": filled(b"time,speed,direction\n0,3,N\n", b"1,2,W\n", 1 << 20)},
        ],
        "POST /api/stand-risk": [
            {"content": filled(b'"', b"a" * 1000)},
            {"content": filled(b"x,y,height\n", b"1,2,9\n", 5000 * 6)},
            {"content": filled(b"x,y,height\n", b"1,2,9\n", 5000 * 6), "params": {"format": "csv"}},
        ],
        "GET /api/inventory": file,
        "GET /api/events": plain,
        "GET /api/jobs/{job_id}/events": plain,
        "GET /healthz": plain,
        "GET /api/health": plain,
        "GET /api/health/ready": plain,
        "GET /metrics": plain,
        "DELETE /api/trees/{tree_id}": plain,
    }  # fmt: skip


@dataclass
class Meter:
    """What the server has written down (metered_server.py), since it was last read."""

    path: Path
    read_bytes: int = 0

    def longest(self) -> dict[str, tuple[float, str]]:
        """Longest times of the event loop and of other threads, in ms, and what took them."""
        with self.path.open("rb") as file:
            file.seek(self.read_bytes)
            text = file.read()
        self.read_bytes += len(text)
        found: dict[str, tuple[float, str]] = defaultdict(lambda: (0.0, ""))
        for line in text.splitlines():
            entry = json.loads(line)
            found[entry["thread"]] = max(found[entry["thread"]], (entry["ms"], entry["what"]))
        return found


def stand(folder: Path) -> Path:
    """The file of as many stems as are planted."""
    path = folder / "stand.csv"
    path.write_text("x,y,height\n" + "".join(f"{k % 160},{k // 160},9\n" for k in range(20_000)))
    return path


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("loop")
    (folder / "data").mkdir()
    environment = {
        **NO_CLUSTER,
        "GALEWOOD_BUILTIN_TREES": "true",
        "GALEWOOD_SPECIES_DIR": str(species_folder(folder)),
        "GALEWOOD_JOB_MODULE": FAKE_JOB,
        "GALEWOOD_WRITES_PER_MINUTE": "0",
        "GALEWOOD_INVENTORY": str(stand(folder)),
        "METER_FILE": str(folder / "meter"),
    }
    server = Server(folder / "data", "tests.server.support.metered_server", environment).start()
    yield server
    server.stop()


def names_of(server: Server, api: httpx.Client) -> Names:
    """Add many trees with reports to the database, and return the names of what the server has."""
    tree = api.get(f"/api/trees/{NAME}").json()
    sessions = open_database(f"sqlite:///{server.data_dir / 'galewood.sqlite'}")
    with sessions.begin() as session:
        for number in range(TREES):
            session.add(
                Tree(
                    name=f"Tree {number}", filename="a.obj", source_sha256=f"{number:064x}", height_m=9.0,
                    report=tree["report"], table_sha256=tree["table_sha256"],
                )
            )  # fmt: skip
    hashes = {
        "tables": tree["table_sha256"], "records": tree["records_sha256"], "meshes": tree["mesh_sha256"],
        "light-meshes": tree["mesh_sha256"], "compliances": tree["compliance_sha256"],
    }  # fmt: skip
    return Names(NAME, tree["job_id"], hashes)


def ask(api: httpx.Client, method: str, path: str, given: dict[str, Any]) -> None:
    """Send a request and read what comes, of a stream only the beginning."""
    with api.stream(method, path, **given) as answer:
        assert answer.status_code < 500 or answer.status_code == 503, (method, path, answer.status_code)
        for _ in answer.iter_bytes():
            if answer.headers.get("content-type", "").startswith("text/event-stream"):
                break


def test_no_request_keeps_the_event_loop_or_the_interpreter(server: Server) -> None:
    meter = Meter(Path(server.environment["METER_FILE"]))
    found: dict[str, dict[str, tuple[float, str]]] = {}
    with httpx.Client(base_url=server.url, timeout=300) as api:
        document = api.get("/openapi.json").json()
        inputs = largest_inputs()
        operations = {f"{m.upper()} {p}" for p, methods in document["paths"].items() for m in methods}
        assert operations == set(inputs)
        names = names_of(server, api)
        for operation, requests in inputs.items():
            method, template = operation.split()
            for number, given in enumerate(requests):
                tries: list[dict[str, tuple[float, str]]] = []
                while len(tries) < TRIES:
                    ask(api, method, names.path(template), given)
                    ask(api, "GET", "/healthz", {})
                    tries.append(meter.longest())
                    if all(ms <= LONGEST_MS for ms, _ in tries[-1].values()):
                        break
                best = {kind: min(one[kind] for one in tries) for kind in ("loop", "other")}
                found[f"{operation} ({number})"] = best
    for name, times in found.items():
        print(f"{name:60s} loop {times['loop'][0]:6.1f} ms, other threads {times['other'][0]:6.1f} ms")
    slow = {
        f"{name}: {kind}": longest
        for name, times in found.items()
        for kind, longest in times.items()
        if longest[0] > LONGEST_MS
    }
    assert not slow
