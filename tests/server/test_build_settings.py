"""What a job is told over HTTP is what the build gets."""

from __future__ import annotations

import json
from typing import Any

import pytest
from galewood.options import BuildRequest
from galewood.pipeline.options import BuildOptions, build_options
from galewood.wood.species import SPECIES
from galewood_server.http.schemas import JobRequest
from pydantic import ValidationError


def options_of(settings: dict[str, Any]) -> BuildOptions:
    """From the request's body, through the database's JSON, to the build."""
    body = json.dumps({"tree_id": "x", "settings": settings})
    request = JobRequest.model_validate(json.loads(body))
    kept = json.loads(json.dumps(request.settings.model_dump(exclude_none=True)))
    return build_options(BuildRequest.model_validate(kept))


def test_everything_that_shapes_a_table_arrives() -> None:
    options = options_of(
        {"species": "maple", "height_m": 9, "up_axis": "z", "wood_materials": ["Bark", "Twig"], "seed": 7,
         "target_tets": 3000, "sampled_elements": 135, "design_speed_m_s": 12.5, "frames": 90, "modes": 24,
         "wood": {"name": "Stiff", "based_on": "maple", "young_longitudinal_pa": 2e10}}
    )  # fmt: skip
    mesh_import = options.mesh_import
    assert (mesh_import.species, mesh_import.height_m, mesh_import.up_axis) == ("maple", 9.0, "z")
    assert mesh_import.wood == ("Bark", "Twig") and options.seed == 7
    assert (options.target_tets, options.sampled_elements) == (3000, 135)
    assert (options.design_speed_m_s, options.frames) == (12.5, 90)
    assert options.table.modes == 24
    assert options.wood is not None and options.wood.young_longitudinal_pa == 2e10
    assert options.wood.density_kg_m3 == SPECIES["maple"].density_kg_m3


def test_nothing_said_is_the_default() -> None:
    assert options_of({}) == BuildOptions()


@pytest.mark.parametrize(
    "settings",
    [{"wood": {"name": "x", "density_kg_m3": -1}}, {"wood": {"based_on": "maple"}}, {"seed": -1},
     {"wood": {"name": "x", "based_on": "no such"}}, {"wood_materials": [""]}, {"design_speed_m_s": 0}],
)  # fmt: skip
def test_nonsense_is_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        options_of(settings)
