"""What a user may choose about an import and a build: the only declaration of every option.

Each field carries its type, its limits, its default and its description. The command line, the Python API,
the REST interface with its forms, and the page's types follow from these models. docs/building.md explains
the options.
"""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from typing import Annotated, Literal, get_args, get_origin

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    field_validator,
    model_validator,
)

from galewood.util import shown_text
from galewood.wood import SPECIES, Wood, WoodDocument, wood_of_species

Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
Stiffness = Literal["visible", "as drawn"]
PartName = Annotated[str, StringConstraints(min_length=1, max_length=200), AfterValidator(shown_text)]
"""A name, cleaned as those of the file are, so that it still means the same part; or the id of a piece."""
MIN_HEIGHT_M, MAX_HEIGHT_M = 0.2, 120.0
"""Heights of trees; the highest known one has 116 m."""
MIN_TETS, USUAL_TETS, MAX_TETS = 500, 5500, 60_000
TRAINING_SEED = 1
AFTER_BEAMS = frozenset(
    {"target_tets", "sampled_elements", "frames", "paper", "bare_table", "all_cosine_winds", "accept"}
)
"""Options on which a table of beams does not depend: one that was made with others will do."""


class ImportRequest(BaseModel):
    """Options of a mesh import. None leaves a choice to the import; its report says what it assumed."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    species: str | None = Field(default=None, description="Wood species; default: guessed from the names.")
    height_m: float | None = Field(
        default=None, ge=MIN_HEIGHT_M, le=MAX_HEIGHT_M, description="Height of the tree, m."
    )
    up_axis: Axis | None = Field(default=None, description="Axis that points up; -z: z points down.")
    wood_parts: list[PartName] | None = Field(
        default=None,
        min_length=1,
        max_length=4000,
        description="What is wood: names of materials, nodes or meshes, or ids of pieces. If a name is "
        "given, all parts that are not named are leaves; ids change only their own pieces.",
    )
    leaves: list[PartName] | None = Field(
        default=None, min_length=1, max_length=4000, description="What is leaves: names, or ids of pieces."
    )
    drop: list[PartName] | None = Field(
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
        ge=0.5,
        le=1500,
        description="Scanned tree: scale all radii to this diameter of the trunk at 1.3 m, cm.",
    )
    min_radius_mm: float | None = Field(
        default=None,
        ge=0,
        le=500,
        description="Scanned tree: drop branches thinner than this, mm; default: 10, or what leaves 200.",
    )
    add_leaves: bool | None = Field(
        default=None,
        description="Scanned tree: add leaves at the ends of branches to the mesh; default: they are added.",
    )
    complete: bool | None = Field(
        default=None,
        description="Whether wood is added where foliage has none: a trunk inside a closed crown, ribs of "
        "fronds, stems of a bush. It bends, but is not drawn. Default: where the foliage needs it.",
    )

    accept: bool | None = Field(
        default=None,
        description="Accept what the import found without asking: what is left out, uncertain pieces, the "
        "up axis, the size.",
    )

    @field_validator("species")
    @classmethod
    def _known(cls, name: str | None) -> str | None:
        if name is not None and name not in SPECIES:
            raise ValueError(f"unknown species {name[:40]!r}; known: {', '.join(sorted(SPECIES))}")
        return name


class TableRequest(BaseModel):
    """Options of the table of a tree that is imported."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    target_tets: int = Field(
        default=USUAL_TETS, ge=MIN_TETS, le=MAX_TETS, description="Number of tetrahedra to aim at."
    )
    sampled_elements: int = Field(
        default=35, ge=1, le=2000, description="Elements sampled for the paper's state search."
    )
    design_speed_m_s: float = Field(
        default=18.0, gt=0, le=60, description="Strongest wind of the runs for the paper's search, m/s."
    )
    frames: int = Field(default=180, ge=2, le=1800, description="Frames of each of the paper's cosine winds.")
    seed: int = Field(default=TRAINING_SEED, ge=0, lt=2**31, description="Seed of the training winds.")
    modes: int | None = Field(
        default=None, ge=2, le=64, description="Oscillators of the modal model; default: 24."
    )
    paper: bool = Field(
        default=True, description="Compute the records of the paper's method after the table."
    )
    foliage: Literal["leaf", "bare"] = Field(
        default="leaf",
        description="Simulate the tree in leaf or bare: the mesh keeps its leaves, which weigh nothing and "
        "catch no wind.",
    )
    bare_table: bool = Field(
        default=False, description="Also compute a table of the same tree without its leaves, for the winter."
    )
    all_cosine_winds: bool = Field(
        default=False, description="Record all 36 cosine winds of the paper instead of 18."
    )
    root_stiffness_knm: float | None = Field(
        default=None,
        ge=0.001,
        le=1e9,
        description="Rotational stiffness of the root plate, kN·m/rad; default: rigid ground.",
    )
    stiffness: Stiffness = Field(
        default="visible",
        description="visible: a stylised tree whose motion would be barely visible gets softer wood, with "
        "the first frequency of real trees of its height; scanned trees keep that of their wood. "
        "as drawn: the stiffness of the wood.",
    )
    first_frequency_hz: float | None = Field(
        default=None,
        ge=0.02,
        le=30,
        description="Scale the stiffness of the wood so that the tree has this first natural frequency, Hz; "
        "default: as stiffness says.",
    )
    sway: float | None = Field(
        default=None,
        ge=0.001,
        le=0.3,
        description="Scale the stiffness of the wood so that a steady wind of 18 m/s bends the tree by this "
        "share of its height; default: as stiffness says.",
    )
    wood: WoodDocument | None = Field(
        default=None, description="Custom wood properties; they take precedence over the species."
    )

    @model_validator(mode="after")
    def _one_stiffness(self) -> TableRequest:
        if self.first_frequency_hz is not None and self.sway is not None:
            raise ValueError("give either first_frequency_hz or sway: both set the stiffness")
        return self

    @property
    def own_wood(self) -> Wood | None:
        """The requested wood; None: that of the species."""
        return self.wood.wood() if self.wood else None

    def wood_of(self, species: str | None) -> Wood:
        """The requested wood, else that of a species; None: an average one."""
        return self.own_wood or wood_of_species(species or "default")

    @property
    def may_soften(self) -> bool:
        """Whether the stiffness is left to the build: nothing else is asked for, and no modulus is given."""
        given = self.wood is not None and self.wood.young_longitudinal_pa is not None
        asked = self.first_frequency_hz is not None or self.sway is not None
        return self.stiffness == "visible" and not asked and not given

    @property
    def root_stiffness_nm_rad(self) -> float | None:
        """Rotational stiffness of the root plate, N·m/rad; None: rigid ground."""
        return None if self.root_stiffness_knm is None else 1000 * self.root_stiffness_knm


class BuildRequest(TableRequest, ImportRequest):
    """Everything that can be chosen about a build, from the mesh to the table."""


def list_fields(model: type[BaseModel]) -> frozenset[str]:
    """The fields of a model that hold several values: given several times, or separated by commas."""
    return frozenset(
        name
        for name, field in model.model_fields.items()
        if list in {get_origin(kind) for kind in (field.annotation, *get_args(field.annotation))}
    )
