"""The message envelope of the wire protocol: prefix, msgpack header, padding, payload.

Specified in spec/formats/wire.md. The functions below `decode_message` validate header fields.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import Any, TypeVar, cast

import msgpack
from galewood.constants import WIRE_MAGIC, WIRE_MAX_HEADER_BYTES, WIRE_PREFIX_BYTES, WIRE_VERSION

MAGIC = WIRE_MAGIC.encode()
MAX_TEXT_BYTES = 32 * 1024

Header = dict[str, Any]
Bytes = TypeVar("Bytes", bytes, memoryview)
# msgpack has no complete type information
_packb = cast(Callable[..., object], getattr(msgpack, "packb"))  # noqa: B009
_unpackb = cast(Callable[..., object], getattr(msgpack, "unpackb"))  # noqa: B009


class WireError(ValueError):
    """An invalid message; `code` is machine-readable."""

    def __init__(self, message: str, code: str = "malformed-message") -> None:
        super().__init__(message)
        self.code = code


def pack_msgpack(document: Header) -> bytes:
    """Encode a document with msgpack."""
    return cast(bytes, _packb(document, use_bin_type=True))


def unpack_msgpack(data: bytes | memoryview) -> object:
    """Decode msgpack with text keys. ValueError, TypeError, RecursionError, msgpack.UnpackException."""
    return _unpackb(data, raw=False, strict_map_key=True, max_str_len=MAX_TEXT_BYTES)


def encode_message(kind: int, header: Header, payload: bytes = b"") -> bytes:
    """Encode a message."""
    packed = pack_msgpack(header)
    prefix = MAGIC + bytes((WIRE_VERSION, kind)) + struct.pack("<I", len(packed))
    return prefix + packed + bytes(-len(packed) % 8) + payload


def decode_message(data: Bytes) -> tuple[int, Header, Bytes]:
    """Decode a message to its kind, header and payload. WireError."""
    if len(data) < WIRE_PREFIX_BYTES or data[:2] != MAGIC:
        raise WireError("not a Galewood message: it must begin with the bytes 'GW'")
    if data[2] != WIRE_VERSION:
        raise WireError(
            f"wire version {data[2]}; this reader knows version {WIRE_VERSION}", "unknown-version"
        )
    (length,) = struct.unpack_from("<I", data, 4)
    start = WIRE_PREFIX_BYTES + length + (-length % 8)
    if length > WIRE_MAX_HEADER_BYTES or start > len(data):
        raise WireError("the header is longer than the message, or than allowed")
    if any(data[WIRE_PREFIX_BYTES + length : start]):
        raise WireError("the padding after the header is not zero")
    return data[3], _unpack(data[WIRE_PREFIX_BYTES : WIRE_PREFIX_BYTES + length]), data[start:]


def _unpack(packed: bytes | memoryview) -> Header:
    try:
        header = unpack_msgpack(packed)
    except (ValueError, TypeError, RecursionError, msgpack.UnpackException) as error:
        raise WireError("the header is not msgpack") from error
    return text_map(header, "the header")


def check_fields(header: Header, *names: str) -> None:
    """Check that a header has exactly these fields. WireError names the first missing or unknown one."""
    missing, unknown = sorted(set(names) - set(header)), sorted(set(header) - set(names))
    if missing:
        raise WireError(f"the field {missing[0]!r} is missing")
    if unknown:
        raise WireError(f"the field {unknown[0][:40]!r} is unknown")


def text(header: Header, name: str) -> str:
    """A text field. WireError."""
    value = header[name]
    if not isinstance(value, str):
        raise WireError(f"{name} must be text")
    return value


def text_map(value: Any, name: str) -> Header:
    """A map with text keys. WireError."""
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in cast(dict[Any, Any], value)):
        raise WireError(f"{name} must be a map with text keys")
    return cast(Header, value)


def list_field(header: Header, name: str) -> list[Any]:
    """A list field. WireError."""
    value = header[name]
    if not isinstance(value, list):
        raise WireError(f"{name} must be a list")
    return cast(list[Any], value)


def whole_number(header: Header, name: str) -> int:
    """A non-negative integer below 2^53, the exact range of JavaScript. WireError."""
    value = header[name]
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**53:
        raise WireError(f"{name} must be a whole number that is not negative")
    return value


def number(header: Header, name: str, low: float = -1e12, high: float = 1e12) -> float:
    """A finite number in low..high. WireError."""
    value = header[name]
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise WireError(f"{name} must be a finite number")
    if not low <= value <= high:
        raise WireError(f"{name} must lie in {low:g}..{high:g}")
    return float(value)


def boolean(header: Header, name: str) -> bool:
    """A Boolean field. WireError."""
    value = header[name]
    if not isinstance(value, bool):
        raise WireError(f"{name} must be true or false")
    return value
