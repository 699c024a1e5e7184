"""Classification of connected pieces as wood, twigs, leaves or no part of the tree, each with a reason.

Evidence of shape, alpha, colour and position is added up for every piece; names of parts are followed where
the evidence does not contradict them. docs/design/0021-pieces.md describes the indicators and their results.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from galewood.formats import RawPart
from galewood.options import ImportRequest
from galewood.tree.pieces.around_trunk import find_around
from galewood.tree.pieces.choices import Choices, read_choices
from galewood.tree.pieces.classified_part import ClassifiedPart, restricted
from galewood.tree.pieces.detection.pieces import Pieces, find_pieces
from galewood.tree.pieces.evidence import (
    SURE_SCORE,
    WOOD_PRIOR_SCORE,
    Evidence,
    add_position,
    is_sheet,
    own_evidence,
)
from galewood.tree.pieces.groups import Group, GroupKind, group_pieces
from galewood.tree.pieces.name_evidence import follow_names, name_hints
from galewood.tree.pieces.names import named_kind, own_kind
from galewood.tree.pieces.other_objects import (
    Others,
    doubts,
    find_ground,
    find_named,
    joined_faces,
)
from galewood.tree.pieces.painted import painted_kinds, with_painted
from galewood.tree.pieces.questions import doubts_of
from galewood.tree.pieces.separate_trees import FoundTree, find_trees
from galewood.tree.types import KINDS, Kind
from galewood.util import Floats, Ints, MeshError

SAME_COLOUR = 0.1
NAMED_ODDS = 8.0  # of a file whose names are known to be right


@dataclass(frozen=True)
class Classification:
    """The parts of the chosen tree by kind, all groups of pieces, and the trees of the file."""

    parts: list[ClassifiedPart]
    groups: list[Group]
    trees: list[FoundTree]
    tree: int  # the chosen one, from 1
    warnings: list[str]
    questions: list[str]  # what should be checked before the tree is used
    unsure_share: float  # of the tree's faces
    group_of_face: list[Ints]  # for each part of the file, the index in `groups` of each face
    pieces: Pieces


def classify(
    parts: list[RawPart], options: ImportRequest, as_named: bool = False, pieces: Pieces | None = None
) -> Classification:
    """Classify all pieces of a file (y up, any unit).

    `as_named`: the names of the parts are known to be right; `pieces`: those of `parts`, if known already.
    Raises MeshError if a choice names nothing.
    """
    pieces = pieces or find_pieces(parts)
    if as_named or all(own_kind(part) for part in parts):
        found = _as_named(pieces, parts, [_kind_by_name(part) for part in parts])
    else:
        found = _analysed(pieces, parts)
    return _chosen(found, parts, options)


def _kind_by_name(part: RawPart) -> Kind:
    kind = own_kind(part)
    for label in part.labels:
        kind = kind or named_kind(label)
    return kind or "wood"


@dataclass(frozen=True)
class _Found:
    """What was found without any choice of the user; the ids of pieces depend on nothing else."""

    pieces: Pieces
    kind: list[Kind]
    reason: list[str]
    odds: Floats  # log odds of what each piece is taken for
    others: Others
    tree: Ints  # of each piece, from 1; 0: none
    trees: list[FoundTree]
    warnings: list[str]


def _as_named(pieces: Pieces, parts: list[RawPart], given: list[Kind]) -> _Found:
    s = pieces.shapes
    tree = FoundTree(s.low.min(axis=0), s.high.max(axis=0), int(s.faces.sum()))
    labels = [next(iter(part.labels), "") for part in parts]
    kinds = [given[p] for p in pieces.part.tolist()]
    reasons = [f"its name {labels[p]!r}" for p in pieces.part.tolist()]
    count = len(pieces)
    return _Found(
        pieces,
        kinds,
        reasons,
        np.full(count, NAMED_ODDS),
        Others(np.zeros(count)),
        np.ones(count, np.int32),
        [tree],
        [],
    )


def _analysed(pieces: Pieces, parts: list[RawPart]) -> _Found:
    evidence = own_evidence(pieces)
    corners, piece = joined_faces(parts, pieces)
    hints = name_hints(parts, pieces)
    others = Others(doubts(pieces, hints))
    hinted = evidence.score + hints
    find_named(parts, pieces, hinted, others)
    find_ground(pieces, hinted, others)
    find_around(corners, piece, pieces, hinted, others)
    tree, trees = find_trees(corners, piece, pieces, hinted, others)
    others.doubt_lost_leaves(pieces, hinted)
    for number in range(1, len(trees) + 1):
        add_position(evidence, pieces, tree == number)
    _follow_colour(evidence, pieces)
    twigs = follow_names(evidence, parts, pieces)
    wood = evidence.score > 0
    kind: list[Kind] = ["twigs" if t else "wood" if w else "leaves" for w, t in zip(wood, twigs, strict=True)]
    odds = np.where(others.left(len(pieces)), np.abs(evidence.score), others.odds)
    found = _Found(pieces, kind, evidence.reasons(wood), odds, others, tree, trees, [])
    return _with_wood(found, evidence)


def _follow_colour(evidence: Evidence, pieces: Pieces) -> None:
    """Pieces of little evidence follow the confident ones of the same part and colour."""
    score = np.clip(evidence.score - WOOD_PRIOR_SCORE, -4.0, 4.0)
    sure = (np.abs(score) >= SURE_SCORE) & pieces.coloured
    added = np.zeros(len(pieces))
    for part in np.unique(pieces.part[~sure]).tolist():
        known = np.flatnonzero(sure & (pieces.part == part))
        weak = np.flatnonzero(~sure & (pieces.part == part) & pieces.coloured)
        if not len(known) or not len(weak):
            continue
        near = np.linalg.norm(pieces.rgb[weak][:, None] - pieces.rgb[known][None], axis=2) < SAME_COLOUR
        weight = near * pieces.shapes.area[known]
        total = weight.sum(axis=1)
        mean = (weight * np.sign(score[known])).sum(axis=1) / np.maximum(total, 1e-300)
        added[weak] = np.where(total > 0, 1.2 * mean, 0.0)
    evidence.add(added != 0, added, "like the other pieces of its part and colour")


def _with_wood(found: _Found, evidence: Evidence) -> _Found:
    """Twigs of a tree without thicker wood are its wood; without any, the most woody solid is taken."""
    kind, reason, warnings = list(found.kind), list(found.reason), list(found.warnings)
    odds = found.odds.copy()
    solid = ~is_sheet(found.pieces.shapes)
    for number in range(1, len(found.trees) + 1):
        own = np.flatnonzero(found.tree == number).tolist()
        if any(kind[k] == "wood" for k in own):
            continue
        for k in own:
            if kind[k] == "twigs":
                kind[k], reason[k] = "wood", f"{reason[k]}, and there is no thicker wood"
        if any(kind[k] == "wood" for k in own):
            continue
        # a crown that is clearly foliage is not turned into wood
        likely = [k for k in own if solid[k] and evidence.score[k] > -2.6]
        for k in likely:
            kind[k], reason[k], odds[k] = "wood", "no wood was recognised", 0.0
        if likely:
            warnings.append(
                "No wood was recognised; the solid pieces are treated as wood. To change it, choose the wood."
            )
    return replace(found, kind=kind, reason=reason, odds=odds, warnings=list(dict.fromkeys(warnings)))


def _chosen(found: _Found, parts: list[RawPart], options: ImportRequest) -> Classification:
    """The classification with the user's choices applied."""
    number = options.tree or 1
    if number > len(found.trees):
        raise MeshError(
            "no-such-tree",
            "unsuitable",
            f"The file has no tree {number}.",
            f"Choose a tree from 1 to {len(found.trees)}.",
        )
    pieces, others = found.pieces, found.others
    groups = group_pieces(pieces, parts, found.kind, found.reason, found.odds, others, found.tree)
    painted, empty = painted_kinds(options, pieces, {label for part in parts for label in part.labels})
    choices = read_choices(options, parts, groups, empty)
    groups = [_decided(group, choices, number) for group in with_painted(groups, pieces, painted)]
    group_of_piece = np.zeros(len(pieces), dtype=np.int32)
    for index, group in enumerate(groups):
        group_of_piece[group.pieces] = index
    group_of_face: list[Ints] = [group_of_piece[of_face] for of_face in pieces.of_face]
    members: dict[tuple[int, GroupKind], list[Group]] = {}
    for group in groups:
        members.setdefault((group.part, group.kind), []).append(group)
    result: list[ClassifiedPart] = []
    for index, part in enumerate(parts):
        vertex_groups = np.full(len(part.positions), -1, dtype=np.int32)
        vertex_groups[part.faces] = group_of_face[index][:, None]
        for kind in KINDS:
            mine = members.get((index, kind))
            if mine:
                taken = np.zeros(len(pieces), dtype=bool)
                taken[np.concatenate([g.pieces for g in mine])] = True
                faces = np.flatnonzero(taken[found.pieces.of_face[index]])
                reason = "; ".join(list(dict.fromkeys(g.reason for g in mine))[:3])
                whole = ClassifiedPart(part, kind, reason, vertex_groups)
                result.append(whole if len(faces) == len(part.faces) else restricted(whole, faces))
    doubt = doubts_of(groups, len(found.trees), number)
    return Classification(
        result,
        groups,
        found.trees,
        number,
        [*found.warnings, *doubt.warnings],
        doubt.questions,
        doubt.unsure_share,
        group_of_face,
        pieces,
    )


def _decided(group: Group, choices: Choices, tree: int) -> Group:
    """A group with the user's choice, or left out if it belongs to another tree."""
    if group.tree not in (0, tree):
        return replace(group, kind="other", what=f"tree {group.tree}", reason="another tree of the file")
    if group.ranges:
        return group
    chosen = choices.of(group)
    if chosen is None:
        return group
    kind, reason = chosen
    return replace(
        group,
        kind=kind,
        what="left out" if kind == "other" else "",
        reason=reason,
        chosen=True,
        probability=1.0,
        unsure_faces=0,
    )
