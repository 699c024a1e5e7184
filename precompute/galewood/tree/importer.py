"""Import of a tree from the bytes of a mesh file: format, axis, unit, wood and foliage, repair.

Every assumption is recorded in the report.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from galewood.formats import FileContent, Material, RawPart, read_parts
from galewood.options import ImportRequest
from galewood.tree.axis import Choice, choose_up_axis, signed, to_y_up
from galewood.tree.joined_parts import joined_parts
from galewood.tree.missing.missing_wood import Completed, complete_wood, foot_of_leaves, synthesize_stems
from galewood.tree.pieces.classification import Classification, classify
from galewood.tree.pieces.classified_part import ClassifiedPart, welded_wood, without_strays
from galewood.tree.pieces.detection.pieces import find_pieces
from galewood.tree.pieces.groups import Group
from galewood.tree.pieces.questions import LEFT_OUT_SHARE
from galewood.tree.pieces.report import pieces_report
from galewood.tree.render_mesh import render_glb
from galewood.tree.repair import Surface
from galewood.tree.scan_ground import without_ground
from galewood.tree.species_names import guess_species, named_habit
from galewood.tree.surface import Bodies, solid_wood
from galewood.tree.types import KINDS, RenderPrimitive, TreeMesh
from galewood.tree.unit import choose_scale
from galewood.tree.usable_parts import as_one_mesh, check_volume, usable_parts
from galewood.util import Floats, MeshError, shown_text

__all__ = [
    "Material",
    "MeshError",
    "RenderPrimitive",
    "TreeMesh",
    "read_tree",
    "render_glb",
]  # fmt: skip

BASE_SLAB = 0.02
SHORT_WOOD = 0.62  # of the height: above it, a crown has too little wood to bend
QSM_UNIT = Choice("m", "cylinder models are in metres", assumed=False)


def read_tree(data: bytes, filename: str, options: ImportRequest | None = None) -> TreeMesh:
    """Read a tree from the bytes of a file. Raises MeshError.

    `filename` only distinguishes formats without a signature and suggests the species; no file is opened.
    """
    options = options or ImportRequest()
    content = read_parts(data, filename, options)
    file_format = content.file_format
    parts, up, classified = classify_content(content, options)
    pieces, warnings, questions = classified.parts, classified.warnings, list(classified.questions)
    _check_wood(pieces, classified.groups, options)
    species, species_reason = guess_species(options.species, filename, parts)
    wood, bodies, repairs, wood_warnings = _solid(pieces)
    if wood:
        drawn, pieces = pieces, without_strays(pieces, wood.vertices, bodies)
        questions += _lost(_face_count(drawn), _face_count(pieces))
    raw_height = content.qsm["height_m"] if content.qsm else _height(pieces)
    habit = _named_habit(filename, classified)
    size = raw_height, species, options, habit or ("bush" if wood is None else None), habit is not None
    scale, unit = (1.0, QSM_UNIT) if content.qsm else choose_scale(*size)
    origin = _base_centre(wood) if wood else foot_of_leaves([s.part for s in pieces])[0]
    pieces = [replace(s, part=_transformed(s.part, np.eye(3), origin, scale)) for s in pieces]
    grown = _completed(wood, origin, scale, pieces, False if content.qsm else options.complete)
    warnings = [*warnings, *(grown.warnings or _short_wood(pieces))]
    if up.unsure:
        questions.append(
            "Unsure about the up axis: choose it if the tree lies on its side. "
            f"It is assumed to be {signed(up.value)}: {up.reason}."
        )
    elif up.assumed:
        warnings.append(f"The up axis is assumed to be {signed(up.value)}: {up.reason}.")
    if unit.unsure:
        questions.append(f"Unsure about the size: {unit.reason}. Give the height.")
    elif unit.value not in ("m", "given"):
        warnings.append(f"The unit is assumed: {unit.reason}.")
    report: dict[str, Any] = {
        "file": {"name": shown_text(filename), "format": file_format, "bytes": len(data)},
        "up_axis": {
            "value": up.value,
            "reason": up.reason,
            "assumed": up.assumed,
            "unsure": up.unsure,
            "confidence": round(up.confidence, 3),
        },
        "unit": {
            "value": unit.value,
            "metres_per_unit": scale,
            "reason": unit.reason,
            "assumed": unit.assumed,
            "unsure": unit.unsure,
        },
        "height_m": raw_height * scale,
        "species": {"value": species, "reason": species_reason},
        "parts": [_part_report(s) for s in pieces],
        **pieces_report(classified, pieces, scale),
        "repairs": repairs,
        "roots": {"origin_in_file": origin.tolist(), "clamped_lowest_share": BASE_SLAB},
        "warnings": content.warnings + warnings + wood_warnings,
        "questions": questions,
        "needs_review": bool(questions) and not options.accept,
    }
    if content.qsm:
        report["qsm"] = content.qsm
    if grown.report:
        report["added_wood"] = grown.report
    return TreeMesh(
        primitives=_primitives(pieces),
        wood_vertices_m=np.ascontiguousarray(grown.wood.vertices),
        wood_faces=grown.wood.faces,
        added_faces=grown.added_faces,
        height_m=raw_height * scale,
        species=species,
        report=report,
    )


def classify_content(
    content: FileContent, options: ImportRequest
) -> tuple[list[RawPart], Choice, Classification]:
    """The usable parts of a file turned y up, the up axis, and the classification of all pieces."""
    parts = joined_parts(usable_parts(content.parts))
    vertices, faces = as_one_mesh(parts)
    check_volume(vertices)
    pieces = find_pieces(parts)
    up = choose_up_axis(vertices, faces, pieces, content.file_format, options)
    rotation = to_y_up(up.value)
    parts = [_transformed(p, rotation, np.zeros(3), 1.0) for p in parts]
    turned = pieces.turned(rotation)
    turned = turned if content.qsm else without_ground(parts, turned)
    return parts, up, classify(parts, options, content.qsm is not None, turned)


def _named_habit(filename: str, found: Classification) -> str | None:
    """A kind of plant that is smaller than trees, if names say so, or a pot stands under it."""
    labels = dict.fromkeys(label for group in found.groups for label in group.labels)
    potted = any(group.what == "pot" for group in found.groups)
    return next((h for h in map(named_habit, (filename, *labels)) if h), "pot plant" if potted else None)


def _lost(before: int, after: int) -> list[str]:
    """A question if many of the faces are no longer drawn."""
    if before - after <= LEFT_OUT_SHARE * before:
        return []
    return [
        f"{before - after:,} of {before:,} faces are left out, because they stand on the ground apart from "
        "the largest body of wood. Check whether they belong to the tree."
    ]


def _face_count(pieces: list[ClassifiedPart]) -> int:
    return sum(len(s.part.faces) for s in pieces)


def _solid(pieces: list[ClassifiedPart]) -> tuple[Surface | None, Bodies, dict[str, int], list[str]]:
    """The drawn wood as in `solid_wood`; None if all is leaves."""
    if not any(s.kind == "wood" for s in pieces):
        return None, Bodies(np.zeros((0, 3)), np.zeros((0, 3))), {}, []
    return solid_wood(welded_wood(pieces))


def _completed(
    wood: Surface | None, origin: Floats, scale: float, pieces: list[ClassifiedPart], asked: bool | None
) -> Completed:
    """The wood in metres with what it lacks to carry its leaves."""
    leaves = [s.part for s in pieces if s.kind == "leaves"]
    if wood is None:
        return synthesize_stems(leaves)
    return complete_wood(Surface((wood.vertices - origin) * scale, wood.faces), leaves, asked)


def _check_wood(pieces: list[ClassifiedPart], groups: list[Group], options: ImportRequest) -> None:
    free = options.complete is not False and options.wood_parts is None
    if any(s.kind == "wood" for s in pieces) or (pieces and free):
        return
    names = sorted({label for g in groups for label in g.labels})[:20] + [g.id for g in groups][:20]
    raise MeshError(
        "no-wood",
        "unsuitable",
        "No wood was found in the mesh: no trunk, no stems, no branches.",
        f"Specify which of these are wood (names, or numbers of pieces): {', '.join(names)}. "
        "A bush that is drawn as leaves only needs stems: allow missing wood to be added (--complete).",
    )


def _transformed(part: RawPart, rotation: Floats, origin: Floats, scale: float) -> RawPart:
    return replace(
        part,
        positions=np.ascontiguousarray((part.positions @ rotation.T - origin) * scale),
        normals=None if part.normals is None else np.ascontiguousarray(part.normals @ rotation.T),
    )


def _height(pieces: list[ClassifiedPart]) -> float:
    """Height of the whole tree above the base of its wood, or of its leaves if it has none."""
    standing = [s for s in pieces if s.kind == "wood"] or pieces
    foot = min(float(s.part.positions[:, 1].min()) for s in standing)
    return max(float(s.part.positions[:, 1].max()) for s in pieces) - foot


def _short_wood(pieces: list[ClassifiedPart]) -> list[str]:
    """A warning if the wood ends low in the crown, which then moves with the end of the wood."""
    top = max(float(s.part.positions[:, 1].max()) for s in pieces if s.kind == "wood")
    foot = min(float(s.part.positions[:, 1].min()) for s in pieces if s.kind == "wood")
    share = (top - foot) / max(_height(pieces), 1e-300)
    if share >= SHORT_WOOD:
        return []
    return [f"The wood ends at {share:.0%} of the height: the crown above moves with the end of the wood."]


def _base_centre(wood: Surface) -> Floats:
    """Centre of the trunk's base, on the ground."""
    y = wood.vertices[:, 1]
    low = float(y.min())
    base = wood.vertices[y <= low + BASE_SLAB * float(np.ptp(y))]
    middle = (base.min(axis=0) + base.max(axis=0)) / 2
    return np.array([middle[0], low, middle[2]])


def _primitives(pieces: list[ClassifiedPart]) -> list[RenderPrimitive]:
    result: list[RenderPrimitive] = []
    for kind in KINDS:
        for number, piece in enumerate(s.part for s in pieces if s.kind == kind):
            result.append(
                RenderPrimitive(
                    f"{kind}_{number}",
                    kind,
                    piece.positions,
                    piece.faces,
                    piece.normals,
                    piece.uv,
                    piece.material,
                    piece.colours,
                )
            )
    return result


def _part_report(piece: ClassifiedPart) -> dict[str, Any]:
    return {
        "names": list(piece.part.labels),
        "faces": len(piece.part.faces),
        "kind": piece.kind,
        "reason": piece.reason,
    }
