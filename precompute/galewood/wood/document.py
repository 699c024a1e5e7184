"""A user-defined wood as a JSON document; omitted fields are taken from a known species."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from galewood.wood.species import Wood, wood_of_species

Ratio = Annotated[float, Field(ge=0.005, le=1.0)]
Modulus = Annotated[float, Field(ge=1e8, le=5e10)]
Density = Annotated[float, Field(ge=100.0, le=1500.0)]
Strength = Annotated[float, Field(ge=1e6, le=1e9)]
Damping = Annotated[float, Field(ge=0.001, le=0.5)]
Drag = Annotated[float, Field(ge=0.05, le=2.0)]
Exponent = Annotated[float, Field(ge=1.0, le=2.0)]


class WoodError(ValueError):
    """An invalid wood document; `problems` lists (field, message)."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        super().__init__(
            "; ".join(f"{field}: {problem}" if field else problem for field, problem in problems)
        )
        self.problems = problems


class WoodDocument(BaseModel):
    """Green wood, transversely isotropic about its fibre. Omitted fields are taken from `based_on`.

    Ratios are relative to the longitudinal modulus; Poisson's ratios are ν_LT and ν_TT; all numbers are
    finite.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)

    name: Annotated[str, Field(min_length=1, max_length=80, description="Display name.")]
    based_on: Annotated[str, Field(description="Species that provides the omitted fields.")] = "default"
    young_longitudinal_pa: Annotated[Modulus | None, Field(description="E along the fibre, Pa.")] = None
    radial_ratio: Annotated[Ratio | None, Field(description="E_R / E_L.")] = None
    tangential_ratio: Annotated[Ratio | None, Field(description="E_T / E_L.")] = None
    shear_lr_ratio: Annotated[Ratio | None, Field(description="G_LR / E_L.")] = None
    shear_lt_ratio: Annotated[Ratio | None, Field(description="G_LT / E_L.")] = None
    poisson_longitudinal: Annotated[float | None, Field(ge=0.0, le=0.6, description="ν_LT.")] = None
    poisson_transverse: Annotated[float | None, Field(ge=0.0, le=0.95, description="ν_TT.")] = None
    density_kg_m3: Annotated[Density | None, Field(description="Density of green wood, kg/m³.")] = None
    modulus_of_rupture_pa: Annotated[
        Strength | None, Field(description="Bending strength of green wood, Pa.")
    ] = None
    damping_ratio: Annotated[Damping | None, Field(description="Damping ratio of the wood.")] = None
    drag_coefficient: Annotated[
        Drag | None, Field(description="Relative to the frontal area of the tree.")
    ] = None
    streamlined_exponent: Annotated[
        Exponent | None,
        Field(description="Power of the wind speed with which the load grows above 5 m/s, in leaf."),
    ] = None
    source: Annotated[str, Field(max_length=500, description="Source of the data.")] = "the user"

    @model_validator(mode="after")
    def _validate_wood(self) -> WoodDocument:
        self.wood()
        return self

    def wood(self) -> Wood:
        """The wood. Raises ValueError if the species is unknown or the constants are inconsistent."""
        try:
            base = wood_of_species(self.based_on)
        except KeyError as error:
            raise ValueError(f"based_on: {error.args[0]}") from None
        names = {field.name for field in fields(Wood)}
        given = {key: value for key, value in self.model_dump(exclude_none=True).items() if key in names}
        return replace(base, **given)


def read_wood_document(text: str | bytes) -> WoodDocument:
    """Parse a JSON document. Raises WoodError with every invalid field."""
    try:
        return WoodDocument.model_validate_json(text)
    except ValidationError as error:
        problems = [(".".join(str(part) for part in one["loc"]), one["msg"]) for one in error.errors()]
        raise WoodError(problems) from None
