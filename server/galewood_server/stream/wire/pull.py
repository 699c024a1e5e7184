"""The messages PULL, RELEASE and GUST of clients, and PULLS, which tells all clients who pulls what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from galewood.constants import (
    MOST_PULLS_OF_FOREST,
    PULL_FORCE_N,
    PULL_PLACE_M,
    PULL_TARGET_M,
    WIRE_GUST,
    WIRE_PULL,
    WIRE_PULLS,
    WIRE_RELEASE,
)

from galewood_server.stream.wire.envelope import (
    Header,
    WireError,
    check_fields,
    encode_message,
    list_field,
    number,
    text_map,
    whole_number,
)

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Pull:
    """A hand moves a vertex of the tree at (x, z) by `target` from rest, m, in the tree's frame, scale 1."""

    hand: int
    x: float
    z: float
    vertex: int
    target: Vector


@dataclass(frozen=True)
class Release:
    """Releases the tree of a hand."""

    hand: int


@dataclass(frozen=True)
class Gust:
    """Sends a gust front through the forest from (x, z), m."""

    x: float
    z: float


@dataclass(frozen=True)
class Pulling:
    """A pull and the force that it exerts, N, in the tree's frame at scale 1."""

    pull: Pull
    force: Vector


@dataclass(frozen=True)
class Pulls:
    """All pulls of a forest at its time `time_s`."""

    time_s: float
    pulls: tuple[Pulling, ...]


def encode_pull(pull: Pull) -> bytes:
    """Encode PULL."""
    return encode_message(WIRE_PULL, _pull_header(pull))


def decode_pull(header: Header) -> Pull:
    """Decode PULL. WireError."""
    check_fields(header, "hand", "x", "z", "vertex", "target")
    return _pull(header)


def encode_release(release: Release) -> bytes:
    """Encode RELEASE."""
    return encode_message(WIRE_RELEASE, {"hand": release.hand})


def decode_release(header: Header) -> Release:
    """Decode RELEASE. WireError."""
    check_fields(header, "hand")
    return Release(whole_number(header, "hand"))


def encode_gust(gust: Gust) -> bytes:
    """Encode GUST."""
    return encode_message(WIRE_GUST, {"x": gust.x, "z": gust.z})


def decode_gust(header: Header) -> Gust:
    """Decode GUST. WireError."""
    check_fields(header, "x", "z")
    return Gust(_place(header, "x"), _place(header, "z"))


def encode_pulls(pulls: Pulls) -> bytes:
    """Encode PULLS."""
    entries = [{**_pull_header(one.pull), "force": list(one.force)} for one in pulls.pulls]
    return encode_message(WIRE_PULLS, {"time_s": pulls.time_s, "pulls": entries})


def decode_pulls(header: Header) -> Pulls:
    """Decode PULLS. WireError."""
    check_fields(header, "time_s", "pulls")
    entries = [text_map(entry, "a pull") for entry in list_field(header, "pulls")]
    if len(entries) > MOST_PULLS_OF_FOREST:
        raise WireError(f"pulls must have at most {MOST_PULLS_OF_FOREST} entries")
    return Pulls(number(header, "time_s"), tuple(_pulling(entry) for entry in entries))


def _pulling(entry: Header) -> Pulling:
    check_fields(entry, "hand", "x", "z", "vertex", "target", "force")
    return Pulling(_pull(entry), _vector(entry, "force", PULL_FORCE_N))


def _pull_header(pull: Pull) -> dict[str, Any]:
    return {
        "hand": pull.hand,
        "x": pull.x,
        "z": pull.z,
        "vertex": pull.vertex,
        "target": list(pull.target),
    }


def _pull(header: Header) -> Pull:
    return Pull(
        whole_number(header, "hand"),
        _place(header, "x"),
        _place(header, "z"),
        whole_number(header, "vertex"),
        _vector(header, "target", PULL_TARGET_M),
    )


def _place(header: Header, name: str) -> float:
    return number(header, name, -PULL_PLACE_M, PULL_PLACE_M)


def _vector(header: Header, name: str, most: float) -> Vector:
    values = list_field(header, name)
    if len(values) != 3:
        raise WireError(f"{name} must have three numbers")
    x, y, z = (number({name: value}, name, -most, most) for value in values)
    return x, y, z
