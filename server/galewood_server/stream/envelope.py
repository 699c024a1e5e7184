"""What every message of the wire looks like, whatever it says: prefix, msgpack map, padding, payload.

Specified in docs/formats/wire.md; twin of web/src/envelope.ts. The readers below check a header's fields.
"""

from __future__ import annotations

import math
import struct
from typing import Any, cast

import msgpack

MAGIC = b"GW"
WIRE_VERSION = 2
PREFIX_BYTES = 8
MAX_HEADER_BYTES = 64 * 1024

Header = dict[str, Any]


class WireError(ValueError):
    """Bytes that are no message of this version; the text says what is wrong, `code` is for programs."""

    def __init__(self, message: str, code: str = "malformed-message") -> None:
        super().__init__(message)
        self.code = code


def encode_message(kind: int, header: Header, payload: bytes = b"") -> bytes:
    """A message from its parts."""
    packed = cast(bytes, msgpack.packb(header, use_bin_type=True))
    prefix = MAGIC + bytes((WIRE_VERSION, kind)) + struct.pack("<I", len(packed))
    return prefix + packed + bytes(-len(packed) % 8) + payload


def decode_message(data: bytes) -> tuple[int, Header, bytes]:
    """Kind, header and payload of a message. WireError."""
    if len(data) < PREFIX_BYTES or data[:2] != MAGIC:
        raise WireError("not a Galewood message: it must begin with the bytes 'GW'")
    if data[2] != WIRE_VERSION:
        raise WireError(
            f"wire version {data[2]} is not spoken here, only version {WIRE_VERSION}", "unknown-version"
        )
    (length,) = struct.unpack_from("<I", data, 4)
    start = PREFIX_BYTES + length + (-length % 8)
    if length > MAX_HEADER_BYTES or start > len(data):
        raise WireError("the header is longer than the message, or than allowed")
    if any(data[PREFIX_BYTES + length : start]):
        raise WireError("the padding after the header is not zero")
    return data[3], _unpack(data[PREFIX_BYTES : PREFIX_BYTES + length]), data[start:]


def _unpack(packed: bytes) -> Header:
    try:
        header = msgpack.unpackb(packed, raw=False, strict_map_key=True, max_str_len=4096)
    except (ValueError, TypeError, RecursionError, msgpack.UnpackException) as error:
        raise WireError("the header is not msgpack") from error
    return text_map(header, "the header")


def only(header: Header, *names: str) -> None:
    """A header has just these fields. WireError names the first that is missing or unknown."""
    missing, unknown = sorted(set(names) - set(header)), sorted(set(header) - set(names))
    if missing:
        raise WireError(f"the field {missing[0]!r} is missing")
    if unknown:
        raise WireError(f"the field {unknown[0][:40]!r} is unknown")


def text(header: Header, name: str) -> str:
    """A text. WireError."""
    value = header[name]
    if not isinstance(value, str):
        raise WireError(f"{name} must be text")
    return value


def text_map(value: Any, name: str) -> Header:
    """A map whose keys are text. WireError."""
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in cast(dict[Any, Any], value)):
        raise WireError(f"{name} must be a map with text keys")
    return cast(Header, value)


def entries(header: Header, name: str) -> list[Any]:
    """A list of anything. WireError."""
    value = header[name]
    if not isinstance(value, list):
        raise WireError(f"{name} must be a list")
    return cast(list[Any], value)


def whole(header: Header, name: str) -> int:
    """A whole number from 0 that JavaScript can hold. WireError."""
    value = header[name]
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**53:
        raise WireError(f"{name} must be a whole number that is not negative")
    return value


def number(header: Header, name: str, low: float = -1e12, high: float = 1e12) -> float:
    """A finite number in a range. WireError."""
    value = header[name]
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise WireError(f"{name} must be a finite number")
    if not low <= value <= high:
        raise WireError(f"{name} must lie in {low:g}..{high:g}")
    return float(value)


def boolean(header: Header, name: str) -> bool:
    """True or false. WireError."""
    value = header[name]
    if not isinstance(value, bool):
        raise WireError(f"{name} must be true or false")
    return value
