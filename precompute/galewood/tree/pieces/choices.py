"""The user's choices: names of materials, nodes or meshes, or ids of pieces, as wood, leaves or left out."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from galewood.formats import RawPart
from galewood.options import ImportRequest
from galewood.tree.pieces.groups import Group, GroupKind
from galewood.tree.pieces.names import named_kind
from galewood.tree.pieces.painted import RANGE_PATTERN
from galewood.util import MeshError

ID_PATTERN = re.compile(r"\d+\.\d+")


@dataclass(frozen=True)
class Choices:
    """What was chosen for each name or id; ids take precedence over names."""

    by_id: dict[str, GroupKind]
    by_name: dict[str, GroupKind]
    only_named_is_wood: bool  # wood was chosen by name: all other parts of the tree are leaves

    def of(self, group: Group) -> tuple[GroupKind, str] | None:
        """The kind chosen for a group and how; None if nothing was chosen."""
        for name in sorted(group.ids & self.by_id.keys()):
            return self.by_id[name], "chosen"
        for label in group.labels:
            if label in self.by_name:
                return self.by_name[label], f"named as {_words(self.by_name[label])}"
        if not self.only_named_is_wood or group.kind == "other":
            return None
        if any(named_kind(label) == "twigs" for label in group.labels):
            return "twigs", "its name, and not named as wood"
        return "leaves", "not named as wood"


def _words(kind: GroupKind) -> str:
    return "left out" if kind == "other" else kind


def read_choices(
    options: ImportRequest, parts: list[RawPart], groups: list[Group], empty: list[str]
) -> Choices:
    """The choices of the options that mean whole groups or parts.

    Raises MeshError if one names nothing in the file; `empty` are ranges of pieces that do not exist.
    """
    labels = {label for part in parts for label in part.labels}
    ids = {name for group in groups for name in group.ids}
    by_id: dict[str, GroupKind] = {}
    by_name: dict[str, GroupKind] = {}
    given: tuple[tuple[GroupKind, Sequence[str]], ...] = (
        ("wood", options.wood_parts or ()),
        ("leaves", options.leaves or ()),
        ("other", options.drop or ()),
    )
    unknown = list(empty)
    for kind, names in given:
        for name in names:
            if name in labels:
                by_name[name] = kind
            elif RANGE_PATTERN.fullmatch(name):
                continue
            elif ID_PATTERN.fullmatch(name):
                by_id[name] = kind
                unknown += [] if name in ids else [name]
            elif kind != "wood":
                unknown.append(name)
    if unknown:
        known = sorted(labels)[:20] + [group.id for group in groups][:20]
        raise MeshError(
            "no-such-piece",
            "unsuitable",
            f"The file has no part or piece {unknown[0][:80]!r}.",
            f"It has: {', '.join(known)}.",
        )
    named = bool(options.wood_parts) and any(
        not (ID_PATTERN.fullmatch(name) or RANGE_PATTERN.fullmatch(name)) or name in labels
        for name in options.wood_parts or ()
    )
    return Choices(by_id, by_name, named)
