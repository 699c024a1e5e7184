"""Single pieces chosen by the user, such as painted ones: "2.14-17" means exactly pieces 14 to 17 of part 2.

A plain id, "2.14", means the whole group of its piece (``piece_groups``).
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from galewood.options import ImportRequest
from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.groups import Group, GroupKind
from galewood.util import Ints

RANGE_PATTERN = re.compile(r"(\d{1,9})\.(\d{1,9})-(\d{1,9})")
KINDS: tuple[GroupKind, ...] = ("wood", "leaves", "other")


def ranges_of(part: int, numbers: Ints) -> list[str]:
    """The numbers of pieces of a part, ascending, as ranges: ["2.14-17", "2.20-20"]."""
    breaks = np.flatnonzero(np.diff(numbers) > 1)
    first = numbers[np.concatenate([[0], breaks + 1])]
    last = numbers[np.concatenate([breaks, [len(numbers) - 1]])]
    return [f"{part}.{a}-{b}" for a, b in zip(first.tolist(), last.tolist(), strict=True)]


def painted_kinds(options: ImportRequest, pieces: Pieces, labels: set[str]) -> tuple[Ints, list[str]]:
    """For each piece the index in KINDS that was chosen for it alone, or −1; and ranges without such pieces.

    What is also the name of a part, in `labels`, is no range.
    """
    chosen = np.full(len(pieces), -1, dtype=np.int32)
    empty: list[str] = []
    for kind, names in enumerate((options.wood_parts, options.leaves, options.drop)):
        for name in names or ():
            found = RANGE_PATTERN.fullmatch(name)
            if found is None or name in labels:
                continue
            part, first, last = (int(number) for number in found.groups())
            rows = (pieces.part == part) & (pieces.number >= first) & (pieces.number <= last)
            chosen[rows] = kind
            empty += [] if rows.any() else [name]
    return chosen, empty


def with_painted(groups: list[Group], pieces: Pieces, chosen: Ints) -> list[Group]:
    """The groups, divided where some of their pieces were chosen alone; the rest keeps its id."""
    result: list[Group] = []
    for group in groups:
        kinds = chosen[group.pieces]
        for code in np.unique(kinds).tolist():
            own = group.pieces[kinds == code]
            part_of_it = _restricted(group, pieces, own)
            result.append(part_of_it if code < 0 else _as_chosen(part_of_it, pieces, KINDS[code]))
    return result


def _restricted(group: Group, pieces: Pieces, own: Ints) -> Group:
    if len(own) == len(group.pieces):
        return group
    faces = pieces.shapes.faces
    total = int(faces[own].sum())
    share = total / max(int(faces[group.pieces].sum()), 1)
    return replace(
        group,
        pieces=own,
        faces=total,
        unsure_faces=round(group.unsure_faces * share),
        low=pieces.shapes.low[own].min(axis=0),
        high=pieces.shapes.high[own].max(axis=0),
    )


def _as_chosen(group: Group, pieces: Pieces, kind: GroupKind) -> Group:
    ranges = ranges_of(group.part, np.sort(pieces.number[group.pieces]))
    return replace(
        group,
        id=ranges[0],
        kind=kind,
        what="left out" if kind == "other" else "",
        reason="painted",
        unsure_faces=0,
        probability=1.0,
        chosen=True,
        ranges=tuple(ranges),
    )
