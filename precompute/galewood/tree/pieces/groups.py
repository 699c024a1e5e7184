"""Groups of pieces for reports and choices: large pieces alone, small ones with their like.

A group's id is "part.piece": the number of the part in the file and of its first piece within the part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from galewood.formats import RawPart
from galewood.tree.pieces.detection.colour import hex_colour
from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.evidence import SURE_SCORE
from galewood.tree.pieces.other_objects import Others
from galewood.tree.types import Kind
from galewood.util import Floats, Ints

LARGE_AREA_SHARE = 0.03  # of the area of all pieces
MAX_LARGE_PIECES = 24  # so many large pieces at most are groups of their own
GroupKind = Literal["wood", "twigs", "leaves", "other"]


@dataclass(frozen=True)
class Group:
    """Pieces of one part that are of one kind."""

    id: str
    part: int
    pieces: Ints
    labels: tuple[str, ...]
    kind: GroupKind
    what: str  # what the group is, if it is left out
    reason: str
    faces: int
    unsure_faces: int
    probability: float  # of its kind, the mean over its faces
    tree: int  # 0: part of no tree
    colour: str | None  # #rrggbb
    low: Floats  # (3,) corners of its box, y up, in the file's unit
    high: Floats
    ids: frozenset[str]  # ids by which any of its pieces may be named
    chosen: bool = False  # by the user
    ranges: tuple[str, ...] = ()  # of its pieces, if they were chosen alone

    @property
    def sure(self) -> bool:
        """Whether the kind of most of its faces is certain."""
        return 2 * self.unsure_faces < self.faces

    def report(self) -> dict[str, Any]:
        """The group as JSON."""
        return {
            "id": self.id,
            "names": list(self.labels),
            "kind": self.kind,
            **({"what": self.what} if self.what else {}),
            "reason": self.reason,
            "faces": self.faces,
            "pieces": len(self.pieces),
            "sure": self.sure,
            "probability": round(self.probability, 3),
            "tree": self.tree,
            "colour": self.colour,
            "chosen": self.chosen,
            **({"ranges": list(self.ranges)} if self.ranges else {}),
        }


def group_pieces(
    pieces: Pieces,
    parts: list[RawPart],
    kind: list[Kind],
    reason: list[str],
    odds: Floats,
    others: Others,
    tree: Ints,
) -> list[Group]:
    """All groups, in the order of the file. They depend on the file alone, not on choices.

    `odds` (k,) are the log odds of what each piece is taken for.
    """
    certainty = 1 / (1 + np.exp(-np.clip(odds, -50, 50)))
    area = pieces.shapes.area
    alone = set(np.argsort(-area, kind="stable")[:MAX_LARGE_PIECES].tolist()) & set(
        np.flatnonzero(area >= LARGE_AREA_SHARE * area.sum()).tolist()
    )
    members: dict[tuple[Any, ...], list[int]] = {}
    for k in range(len(pieces)):
        other = others.what.get(k)
        key = (int(pieces.part[k]), int(tree[k]), "other" if other else kind[k], other[0] if other else "")
        members.setdefault((*key, k if k in alone else -1), []).append(k)
    groups: list[Group] = []
    for (part, number, what_kind, what, _), rows in members.items():
        largest = max(rows, key=lambda k: float(area[k]))
        chosen = np.array(rows, dtype=np.int32)
        numbers = pieces.number[chosen]
        faces = pieces.shapes.faces[chosen]
        other = others.what.get(largest)
        rgb = np.average(pieces.rgb[chosen], axis=0, weights=area[chosen])
        groups.append(
            Group(
                id=f"{part}.{numbers[0]}",
                part=part,
                pieces=chosen,
                labels=parts[part].labels,
                kind=what_kind,
                what=what,
                reason=other[1] if other else reason[largest],
                faces=int(faces.sum()),
                unsure_faces=int(faces[odds[chosen] < SURE_SCORE].sum()),
                probability=float(np.average(certainty[chosen], weights=faces)),
                tree=number,
                colour=hex_colour(rgb) if bool(pieces.coloured[chosen].any()) else None,
                low=pieces.shapes.low[chosen].min(axis=0),
                high=pieces.shapes.high[chosen].max(axis=0),
                ids=frozenset(f"{part}.{n}" for n in numbers.tolist()),
            )
        )
    return groups
