"""What a user may choose about a build: one model, from which the command line and the REST interface follow.

Everything left out keeps its default; docs/building.md describes the options.
"""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, field_validator, model_validator

from galewood.wood import SPECIES, WoodDocument

if TYPE_CHECKING:  # the service validates requests without loading the mesh libraries
    from galewood.mesh import ImportOptions

MaterialName = Annotated[str, StringConstraints(min_length=1, max_length=200)]


class ImportRequest(BaseModel):
    """What mesh import would otherwise have to assume; the tree's report says what it did assume."""

    model_config = ConfigDict(extra="forbid")

    species: str | None = Field(default=None, description="Wood species; default: guessed from the names.")
    height_m: float | None = Field(default=None, gt=0.1, le=150, description="Height of the tree, m.")
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = Field(
        default=None, description="Axis that points up; -z: z points down."
    )
    wood_materials: list[MaterialName] | None = Field(
        default=None,
        min_length=1,
        max_length=4000,
        description="What is wood: names of materials, nodes or meshes, or ids of pieces. If a name is "
        "given, all parts that are not named are leaves; ids change only their own pieces.",
    )
    leaves: list[MaterialName] | None = Field(
        default=None, min_length=1, max_length=4000, description="What is leaves: names, or ids of pieces."
    )
    drop: list[MaterialName] | None = Field(
        default=None,
        min_length=1,
        max_length=4000,
        description="What is left out, such as ground: names, or ids of pieces.",
    )
    tree: int | None = Field(
        default=None,
        ge=1,
        le=10_000,
        description="Which tree of a file with several, as numbered in the report; default: the largest.",
    )
    dbh_cm: float | None = Field(
        default=None,
        gt=0.5,
        le=1500,
        description="Scanned tree: scale all radii to this diameter of the trunk at 1.3 m, cm.",
    )
    min_radius_mm: float | None = Field(
        default=None,
        ge=0,
        le=500,
        description="Scanned tree: drop branches thinner than this, mm; default: 10, or what leaves 200.",
    )
    bare: bool | None = Field(
        default=None,
        description="Scanned tree: add no leaves to the mesh; default: leaves at the ends of branches.",
    )

    complete: bool | None = Field(
        default=None,
        description="Whether wood is added where foliage has none: a trunk inside a closed crown, ribs of "
        "fronds, stems of a bush. It bends, but is not drawn. Default: where the foliage needs it.",
    )

    @field_validator("species")
    @classmethod
    def _known(cls, name: str | None) -> str | None:
        if name is not None and name not in SPECIES:
            raise ValueError(f"unknown species {name[:40]!r}; known: {', '.join(sorted(SPECIES))}")
        return name


class BuildRequest(ImportRequest):
    """Everything that can be chosen about a build."""

    target_tets: int | None = Field(default=None, ge=500, le=60_000, description="Tetrahedra to aim at.")
    sampled_elements: int | None = Field(
        default=None, ge=1, le=2000, description="Elements sampled for the paper's state search."
    )
    design_speed_m_s: float | None = Field(
        default=None, gt=0, le=60, description="Strongest wind of the training runs, m/s."
    )
    frames: int | None = Field(
        default=None, ge=2, le=1800, description="Frames of each of the paper's cosine winds."
    )
    seed: int | None = Field(default=None, ge=0, lt=2**31, description="Seed of the training winds.")
    modes: int | None = Field(
        default=None,
        ge=2,
        le=64,
        description="Oscillators of the modal model; default: 16, or 48 for a tree that bends far.",
    )
    paper: bool | None = Field(
        default=None, description="Whether to compute the records of the paper's method; default: yes."
    )
    foliage: Literal["leaf", "bare"] | None = Field(
        default=None,
        description="Simulate the tree in leaf (default) or bare: the mesh keeps its leaves, which weigh "
        "nothing and catch no wind.",
    )
    bare_table: bool | None = Field(
        default=None,
        description="Also compute a table of the same tree without its leaves, for the winter; default: no.",
    )
    all_cosine_winds: bool | None = Field(
        default=None, description="Record all 36 cosine winds of the paper instead of 18; default: no."
    )
    root_stiffness_knm: float | None = Field(
        default=None,
        ge=0.001,
        le=1e9,
        description="Rotational stiffness of the root plate, kN·m/rad; default: rigid ground.",
    )
    first_frequency_hz: float | None = Field(
        default=None,
        ge=0.02,
        le=30,
        description="Scale the stiffness of the wood so that the tree has this first natural frequency, Hz; "
        "default: as stiff as its wood.",
    )
    sway: float | None = Field(
        default=None,
        ge=0.001,
        le=0.3,
        description="Scale the stiffness of the wood so that a steady wind of 18 m/s bends the tree by this "
        "share of its height; default: as stiff as its wood.",
    )
    wood: WoodDocument | None = Field(
        default=None, description="Constants of a wood of your own; they take precedence over the species."
    )

    @model_validator(mode="after")
    def _one_stiffness(self) -> BuildRequest:
        if self.first_frequency_hz is not None and self.sway is not None:
            raise ValueError("give either first_frequency_hz or sway: both set the stiffness")
        return self


def import_options(request: ImportRequest) -> ImportOptions:
    """The options of mesh import."""
    from galewood.mesh import ImportOptions

    wood = tuple(request.wood_materials) if request.wood_materials else None
    return ImportOptions(
        request.species,
        request.height_m,
        request.up_axis,
        wood,
        request.dbh_cm,
        request.min_radius_mm,
        bool(request.bare),
        tuple(request.leaves) if request.leaves else None,
        tuple(request.drop) if request.drop else None,
        request.tree,
        request.complete,
    )
