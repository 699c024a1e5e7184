"""Parts that a file splits although they are one: the same names and material, so that pieces stay whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from galewood.mesh.types import RawPart
from galewood.util import Floats

EXTRAS = ("normals", "uv", "colours")


def joined_parts(parts: list[RawPart]) -> list[RawPart]:
    """Parts with the same labels, material and attributes as one each, in the order of their first ones."""
    groups: list[list[RawPart]] = []
    for part in parts:
        same = next((group for group in groups if _belong_together(group[0], part)), None)
        if same is None:
            groups.append([part])
        else:
            same.append(part)
    return [_joined(group) for group in groups]


def _belong_together(a: RawPart, b: RawPart) -> bool:
    alike = all((getattr(a, name) is None) == (getattr(b, name) is None) for name in EXTRAS)
    return alike and a.labels == b.labels and a.material == b.material


def _joined(parts: list[RawPart]) -> RawPart:
    if len(parts) == 1:
        return parts[0]
    offsets = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])

    def rows(name: str) -> Floats | None:
        return None if getattr(parts[0], name) is None else np.concatenate([getattr(p, name) for p in parts])

    return replace(
        parts[0],
        positions=np.concatenate([part.positions for part in parts]),
        faces=np.concatenate([p.faces + o for p, o in zip(parts, offsets, strict=True)]).astype(np.int32),
        normals=rows("normals"),
        uv=rows("uv"),
        colours=rows("colours"),
    )
