"""The messages FOREST, which requests a forest, and SHARED, which describes a shared one."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, cast

import numpy as np
import numpy.typing as npt
from galewood.constants import FOREST_OPTIONS, MOST_ABOUT_ENTRIES, WIRE_FOREST, WIRE_SHARED
from galewood.options import METHOD_NAMES, Method

from galewood_server.stream.wire.envelope import (
    Header,
    WireError,
    boolean,
    check_fields,
    encode_message,
    list_field,
    number,
    text,
    text_map,
    whole_number,
)

Mode = Literal["stream", "table"]
Trees = npt.NDArray[np.float32]
About = Mapping[str, str | int | float | bool]
_SHARE = re.compile(r"[A-Za-z0-9_-]{1,64}")


@dataclass(frozen=True)
class Group:
    """`count` trees that share one table (SHA-256 in hex)."""

    table: str
    count: int


@dataclass(frozen=True)
class Forest:
    """A forest request: tables for lookup in the client, or a stream of poses of the given trees."""

    mode: Mode
    groups: tuple[Group, ...]
    wind: Mapping[str, Any]
    time_s: float
    pose_easing: float | None
    trees: Trees  # (Σ count, 4): x (m), z (m), yaw (rad), scale; (0, 4) if not needed
    method: Method = "modal"
    share: str | None = None
    """Identifier of a shared forest; None for a private one."""
    replant: bool = False
    """Replace the trees of the shared forest, for all clients, if they differ."""
    about: About = field(default_factory=lambda: cast(About, {}))
    """Client-defined data passed to other clients unchanged."""
    have: Mapping[str, int] = field(default_factory=lambda: cast(Mapping[str, int], {}))
    """SHA-256 of a table -> bytes that the client has already received."""

    @property
    def tree_count(self) -> int:
        """Number of trees, also if their places are not given."""
        return sum(group.count for group in self.groups)


@dataclass(frozen=True)
class Shared:
    """Description of a shared forest, sent to joining clients and when its trees are replaced."""

    share: str
    groups: tuple[Group, ...]
    pose_easing: float | None
    method: Method
    about: About
    trees: Trees


def encode_forest(forest: Forest) -> bytes:
    """Encode FOREST: groups in the header, four float32 per tree in the payload."""
    header = {
        "mode": forest.mode,
        "groups": _group_list(forest.groups),
        "options": _options(forest),
        "wind": dict(forest.wind),
        "time_s": forest.time_s,
    }
    return encode_message(WIRE_FOREST, header, np.ascontiguousarray(forest.trees, "<f4").tobytes())


def decode_forest(header: Header, payload: bytes) -> Forest:
    """Decode FOREST. WireError."""
    check_fields(header, "mode", "groups", "options", "wind", "time_s")
    mode = text(header, "mode")
    if mode not in ("stream", "table"):
        raise WireError("mode must be 'stream' or 'table'")
    options = text_map(header["options"], "options")
    check_fields(options, *options.keys() & set(FOREST_OPTIONS))
    groups = tuple(_group(entry) for entry in list_field(header, "groups"))
    has_trees = mode == "stream" or bool(payload)
    return Forest(
        mode=mode,
        groups=groups,
        wind=text_map(header["wind"], "wind"),
        time_s=number(header, "time_s", -1e9, 1e9),
        pose_easing=_easing(options),
        trees=_trees(payload, sum(group.count for group in groups) if has_trees else 0),
        method=_method(options) if "method" in options else "modal",
        share=_share(options) if "share" in options else None,
        replant="replant" in options and boolean(options, "replant"),
        about=_about(options) if "about" in options else {},
        have=_have(options) if "have" in options else {},
    )


def encode_shared(shared: Shared) -> bytes:
    """Encode SHARED, with the trees in the payload as in FOREST."""
    header = {
        "share": shared.share,
        "groups": _group_list(shared.groups),
        "pose_easing": shared.pose_easing,
        "method": shared.method,
        "about": dict(shared.about),
    }
    return encode_message(WIRE_SHARED, header, np.ascontiguousarray(shared.trees, "<f4").tobytes())


def decode_shared(header: Header, payload: bytes) -> Shared:
    """Decode SHARED. WireError."""
    check_fields(header, "share", "groups", "pose_easing", "method", "about")
    groups = tuple(_group(entry) for entry in list_field(header, "groups"))
    return Shared(
        share=_share(header),
        groups=groups,
        pose_easing=None if header["pose_easing"] is None else _easing(header),
        method=_method(header),
        about=_about(header),
        trees=_trees(payload, sum(group.count for group in groups) if payload else 0),
    )


def _group_list(groups: tuple[Group, ...]) -> list[dict[str, Any]]:
    return [{"table": group.table, "count": group.count} for group in groups]


def _options(forest: Forest) -> dict[str, Any]:
    """The options that differ from their defaults."""
    given: dict[str, Any] = {
        "pose_easing": forest.pose_easing,
        "method": None if forest.method == "modal" else forest.method,
        "share": forest.share,
        "replant": forest.replant or None,
        "about": dict(forest.about) or None,
        "have": dict(forest.have) or None,
    }
    return {name: value for name, value in given.items() if value is not None}


def _easing(options: Header) -> float | None:
    return number(options, "pose_easing", 0.0, 1.0) if "pose_easing" in options else None


def _method(options: Header) -> Method:
    method = text(options, "method")
    if method not in METHOD_NAMES:
        raise WireError(f"method must be {' or '.join(map(repr, METHOD_NAMES))}")
    return method


def is_share(name: str) -> bool:
    """Whether a text can name a shared forest."""
    return _SHARE.fullmatch(name) is not None


def _share(options: Header) -> str:
    share = text(options, "share")
    if not is_share(share):
        raise WireError("share must be 1 to 64 letters, digits, '-' or '_'")
    return share


def _about(options: Header) -> About:
    about = text_map(options["about"], "about")
    if len(about) > MOST_ABOUT_ENTRIES:
        raise WireError(f"about may have up to {MOST_ABOUT_ENTRIES} entries")
    for name, value in about.items():
        if (
            len(name) > 64
            or not isinstance(value, str | int | float)
            or (isinstance(value, str) and len(value) > 200)
        ):
            raise WireError("about must map short names to numbers, booleans or short texts")
        if not isinstance(value, str | bool):
            number(about, name, -(2**53), 2**53)
    return about


def _have(options: Header) -> Mapping[str, int]:
    have = text_map(options["have"], "have")
    for table in have:
        _check_hash(table)
        whole_number(have, table)
    return have


def _group(entry: Any) -> Group:
    group = text_map(entry, "a group")
    check_fields(group, "table", "count")
    return Group(_check_hash(text(group, "table")), whole_number(group, "count"))


def _check_hash(table: str) -> str:
    if len(table) != 64 or set(table) - set("0123456789abcdef"):
        raise WireError("table must be a SHA-256 in hex")
    return table


def _trees(payload: bytes, count: int) -> Trees:
    if len(payload) != count * 16:
        raise WireError(f"the payload has {len(payload)} bytes; {count} trees need {count * 16}")
    trees = np.frombuffer(payload, "<f4").reshape(count, 4)
    if not np.isfinite(trees).all() or (np.abs(trees) > 1e6).any():
        raise WireError("a tree's position, yaw or scale is not a valid number")
    if count and not ((trees[:, 3] >= 0.01) & (trees[:, 3] <= 100)).all():
        raise WireError("a tree's scale must lie in 0.01..100")
    return trees
