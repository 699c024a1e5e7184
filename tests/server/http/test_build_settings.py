"""Build settings from the HTTP request to the build."""

from __future__ import annotations

import json
from typing import Any

import pytest
from galewood.pipeline.tables.options import BuildOptions
from galewood.wood.species import SPECIES
from galewood_server.http.schemas import JobRequest
from pydantic import ValidationError


def options_of(settings: dict[str, Any]) -> BuildOptions:
    """Build options of a request body, via JSON in the database."""
    body = json.dumps({"tree_id": "x", "settings": settings})
    request = JobRequest.model_validate(json.loads(body))
    return BuildOptions.model_validate(json.loads(json.dumps(request.settings.given())))


def test_all_settings_reach_the_build() -> None:
    options = options_of(
        {"species": "maple", "height_m": 9, "up_axis": "z", "wood_parts": ["Bark", "Twig"], "seed": 7,
         "target_tets": 3000, "sampled_elements": 135, "design_speed_m_s": 12.5, "frames": 90, "modes": 24,
         "wood": {"name": "Stiff", "based_on": "maple", "young_longitudinal_pa": 2e10}}
    )  # fmt: skip
    assert (options.species, options.height_m, options.up_axis) == ("maple", 9.0, "z")
    assert options.wood_parts == ["Bark", "Twig"] and options.seed == 7
    assert (options.target_tets, options.sampled_elements) == (3000, 135)
    assert (options.design_speed_m_s, options.frames) == (12.5, 90)
    assert options.table.modes == 24
    wood = options.own_wood
    assert wood is not None and wood.young_longitudinal_pa == 2e10
    assert wood.density_kg_m3 == SPECIES["maple"].density_kg_m3


def test_choices_of_pieces_reach_the_import() -> None:
    found = options_of({"leaves": ["1.0"], "drop": ["ground", "2.0"], "tree": 2})
    assert (found.leaves, found.drop, found.tree) == (["1.0"], ["ground", "2.0"], 2)


def test_missing_settings_are_the_defaults() -> None:
    assert options_of({}) == BuildOptions()


@pytest.mark.parametrize(
    "settings",
    [{"wood": {"name": "x", "density_kg_m3": -1}}, {"wood": {"based_on": "maple"}}, {"seed": -1},
     {"wood": {"name": "x", "based_on": "no such"}}, {"wood_parts": [""]}, {"design_speed_m_s": 0}],
)  # fmt: skip
def test_invalid_settings_are_rejected(settings: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        options_of(settings)


def test_options_of_scanned_trees_reach_the_import() -> None:
    found = options_of({"dbh_cm": 31.5, "min_radius_mm": 0, "add_leaves": False})
    assert (found.dbh_cm, found.min_radius_mm, found.add_leaves) == (31.5, 0.0, False)
    assert options_of({}).add_leaves is None
