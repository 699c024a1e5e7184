"""Parts of a tree as a file draws them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Material:
    """A glTF material; texture indices are replaced by keys of `images`."""

    json: dict[str, Any] = field(default_factory=dict[str, Any])
    images: dict[str, tuple[bytes, str]] = field(
        default_factory=dict[str, tuple[bytes, str]]
    )  # key: (bytes, MIME type)
    samplers: dict[str, dict[str, Any]] = field(default_factory=dict[str, dict[str, Any]])


@dataclass(frozen=True)
class RawPart:
    """A part as read from the file, in the file's axes and units."""

    labels: tuple[str, ...]  # material, node and mesh names, in order of precedence
    positions: Floats
    faces: Ints
    normals: Floats | None = None
    uv: Floats | None = None
    colours: Floats | None = None
    material: Material | None = None
