"""The shared constants are written once, and the check of it finds what it looks for."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from galewood import constants

from scripts.check_constants import declarations, findings, plain_value
from scripts.write_constants import ROOT, SOURCE_FILE, generated, read_groups, write

GROUPS = {
    "motion": {
        "MOST_STEPS": {"value": 8, "meaning": "Most steps."},
        "AIR_SPEED_M_S": {"value": 5.0, "unit": "m/s", "meaning": "A speed.", "kernel": True},
        "WIND_NAMES": {"value": ["still", "storm"], "meaning": "Names."},
    }
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project whose two modules import the shared constants."""
    (tmp_path / "spec").mkdir()
    (tmp_path / SOURCE_FILE).write_text(json.dumps(GROUPS))
    for path in generated(tmp_path):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
    write(tmp_path)
    names = ", ".join(GROUPS["motion"])
    (tmp_path / "precompute/galewood/step.py").write_text(f"from galewood.constants import {names}\n")
    (tmp_path / "web/player/src/core/step.ts").write_text(f'import {{ {names} }} from "./constants";\n')
    return tmp_path


def appended(path: Path, line: str) -> None:
    with path.open("a", encoding="utf-8") as file:
        file.write(line + "\n")


def test_this_project_and_a_small_one_type_every_constant_once(project: Path) -> None:
    assert findings(ROOT) == []
    assert findings(project) == []


@pytest.mark.parametrize("line", [
    "MOST_STEPS = 8", "_MOST_STEPS: int = 7", "AIR_SPEED_M_S, OTHER_M = 5.0, 2.0",
    'WIND_NAMES = (\n    "still",\n)',
])  # fmt: skip
def test_a_typed_constant_is_found_in_python(project: Path, line: str) -> None:
    appended(project / "precompute/galewood/step.py", line)
    (found,) = findings(project)
    assert found.startswith("precompute/galewood/step.py:2: ") and found.endswith("is shared: import it")


@pytest.mark.parametrize("line", [
    "const MOST_STEPS = 8;", "export const AIR_SPEED_M_S: f32 = 5;", 'const WIND_NAMES = ["calm"] as const;',
])  # fmt: skip
def test_a_typed_constant_is_found_in_typescript(project: Path, line: str) -> None:
    appended(project / "web/player/src/core/step.ts", line)
    (found,) = findings(project)
    assert found.startswith("web/player/src/core/step.ts:2: ")


def test_a_constant_that_both_languages_type_is_found(project: Path) -> None:
    appended(project / "precompute/galewood/step.py", "_HALF_LIFE_S = 2.5")
    assert findings(project) == []
    appended(project / "web/player/src/core/step.ts", "const HALF_LIFE_S = 5 / 2; // s")
    (found,) = findings(project)
    assert "web/player/src/core/step.ts:2: HALF_LIFE_S is typed in precompute/galewood/step.py:2" in found


def test_an_alias_and_another_value_are_no_findings(project: Path) -> None:
    appended(project / "precompute/galewood/step.py", "DOUBLE_STEPS = 2 * MOST_STEPS\nGRACE_S = 1.0")
    appended(project / "web/player/src/core/step.ts", "const GRACE_S = 3;\nconst MOST = MOST_STEPS;")
    assert findings(project) == []


@pytest.mark.parametrize("path", generated(ROOT))
def test_a_stale_file_is_found(project: Path, path: str) -> None:
    appended(project / path, "")
    assert findings(project) == [f"{path}: stale; run `make constants`"]
    (project / path).unlink()
    assert findings(project)[0] == f"{path}: stale; run `make constants`"


def test_a_constant_of_one_language_is_found(project: Path) -> None:
    (project / "web/player/src/core/step.ts").write_text("")
    assert len(findings(project)) == 3
    assert findings(project)[0] == f"{SOURCE_FILE}: MOST_STEPS is not used in TypeScript"


@pytest.mark.parametrize("name", ["MOST", "most_steps"])
def test_a_name_of_one_word_is_refused(project: Path, name: str) -> None:
    (project / SOURCE_FILE).write_text(json.dumps({"motion": {name: {"value": 1, "meaning": "Something."}}}))
    with pytest.raises(ValueError, match=name):
        read_groups(project)


def test_values_keep_every_bit() -> None:
    typescript = typescript_values()
    for group in read_groups(ROOT).values():
        for name, entry in group.items():
            assert equal(getattr(constants, name), entry["value"]), name
            if isinstance(entry["value"], float):
                assert float(typescript[name]) == entry["value"], name


def equal(found: Any, wanted: Any) -> bool:
    """Whether a constant of Python is the value of the specification, of the same types."""
    if isinstance(wanted, list):
        return len(found) == len(wanted) and all(map(equal, found, wanted))
    if isinstance(wanted, dict):
        return list(found) == list(wanted) and all(map(equal, found.values(), wanted.values()))
    return type(found) is type(wanted) and found == wanted


def typescript_values() -> dict[str, Any]:
    """Value by name of the constants in TypeScript, except the kernel's."""
    texts = {
        path: text for path, text in generated(ROOT).items() if path.startswith(("web/player", "web/src"))
    }
    return {one.name: one.value for path, text in texts.items() for one in declarations(path, text)}


def test_derived_constants_follow_from_the_others() -> None:
    density, speed_m_s = constants.HALF_AIR_DENSITY_KG_M3, constants.STREAMLINING_SPEED_M_S
    assert density * speed_m_s**2 == constants.STREAMLINING_PRESSURE_PA
    assert 2.0 * math.pi / 2**32 == constants.HASH_TURN_RAD
    isotropic = constants.ISOTROPIC_DRAG
    assert isotropic == 4.0 / 3.0
    beta = constants.WIND_FIELDS["beta"]["default"]
    assert beta == 5.0 / 3.0
    assert (constants.HASH_GOLDEN, constants.HASH_FACTOR) == (0x9E3779B9, 0x45D9F3B)
    assert math.fsum(wave["share"] for wave in constants.FOREST_WAVES) == 1.0


@pytest.mark.parametrize(("text", "value"), [
    ("1 << 20", 2**20), ("4.0 / 3.0  # four thirds", 4 / 3), ("4 / 3; // four thirds", 4 / 3),
    ("[4, 7] as const;", (4, 7)), ("(4, 7)", (4, 7)), ("20_000;", 20000), ('"GW";', "GW"),
    ("max(1, 2)", None), ("(", None), ("{", None),
])  # fmt: skip
def test_plain_values_are_read_in_both_languages(text: str, value: object) -> None:
    assert plain_value(text) == value
