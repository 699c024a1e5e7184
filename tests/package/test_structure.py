"""`make check` finds what is too large and what nobody uses: each violation is planted in a copy and found.

Planted imports are in test_import_contracts.py and tests/web/layers.test.ts.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scripts import structure as limits

REPOSITORY = Path(__file__).parents[2]
VULTURE = Path(sys.executable).with_name("vulture")
LEFT_OUT = shutil.ignore_patterns("__pycache__", "node_modules", "dist", "data", "*.glb", "*.npz")


def checked(command: list[str | Path], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def copied(parts: tuple[str, ...], target: Path) -> Path:
    """A copy of files and folders of the repository."""
    for part in parts:
        source = REPOSITORY / part
        (target / part).parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target / part, ignore=LEFT_OUT, dirs_exist_ok=True)
        else:
            shutil.copy(source, target / part)
    return target


# ---- sizes --------------------------------------------------------------------------------------------


def structure(folder: Path) -> subprocess.CompletedProcess[str]:
    return checked([sys.executable, "-m", "scripts.structure", folder], REPOSITORY)


def idle_entries_left_out(found: str) -> list[str]:
    """The problems of an empty folder are that no exception is needed there."""
    return [line for line in found.splitlines() if "no exception any more" not in line]


def test_the_sources_keep_the_limits() -> None:
    found = structure(REPOSITORY)
    assert (found.returncode, found.stdout) == (0, ""), found.stdout + found.stderr


def test_a_folder_of_sixteen_files_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "web" / "src" / "planted"
    folder.mkdir(parents=True)
    for number in range(15):
        (folder / f"file{number}.ts").touch()
    assert idle_entries_left_out(structure(tmp_path).stdout) == []
    (folder / "file15.ts").touch()
    found = structure(tmp_path)
    assert found.returncode == 1
    assert idle_entries_left_out(found.stdout) == ["web/src/planted: 16 source files, at most 15"]


def test_a_package_named_results_is_read_and_the_output_of_tests_is_not(tmp_path: Path) -> None:
    for name in ("server/galewood_server/results", "tests/e2e/results"):
        (tmp_path / name).mkdir(parents=True)
        for number in range(16):
            (tmp_path / name / f"file{number}.py").touch()
    assert idle_entries_left_out(structure(tmp_path).stdout) == [
        "server/galewood_server/results: 16 source files, at most 15"
    ]


@pytest.mark.parametrize(
    "text",
    [
        "def planted({}): ...",
        "async def planted(*, {}): ...",
        "class Planted:\n    def planted(self, {}): ...",
    ],
)
def test_a_function_of_ten_parameters_is_found(tmp_path: Path, text: str) -> None:
    (tmp_path / "server").mkdir()
    names = [f"p{number}" for number in range(10)]
    (tmp_path / "server" / "planted.py").write_text(text.format(", ".join(names[:9])))
    assert idle_entries_left_out(structure(tmp_path).stdout) == []
    (tmp_path / "server" / "planted.py").write_text(text.format(", ".join(names)))
    found = structure(tmp_path)
    assert found.returncode == 1
    assert [line.partition("planted: ")[2] for line in idle_entries_left_out(found.stdout)] == [
        "10 parameters, at most 9"
    ]


def test_an_exception_that_is_not_needed_is_found(tmp_path: Path) -> None:
    known = {"crowded": 20, "small": 18, "gone": 16}
    assert limits.problems("source files", {"crowded": 21, "small": 15}, 15, known) == [
        "crowded: 21 source files, at most 20",
        "small: 15 source files are no exception any more: remove it from scripts/structure.py",
        "gone: 0 source files are no exception any more: remove it from scripts/structure.py",
    ]


# ---- names --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "text", "names"),
    [
        ("server/planted.py", "SLENDER = 2.2\n", ["SLENDER"]),
        ("server/planted.py", "ROUNDS: int = 6\nMAX_ROUNDS = 6\n", ["ROUNDS"]),
        ("scripts/planted.py", "LEAST, MOST_M = 1 << 4, 0.9\nHINT = 'Export it again.'\n", ["LEAST", "HINT"]),
        ("precompute/planted.py", "AXES = ('x', 'y')\nVERSION = 1\ndef f():\n    MOST = 1\n", []),
        (
            "web/src/planted.ts",
            "const SLENDER = 0.009;\nexport const TURN = 2 * Math.PI;\n",
            ["SLENDER", "TURN"],
        ),
        ("web/src/planted.ts", "const HALF: number = GRID_CELLS / 2;\nconst ROWS = 5;\n", ["HALF", "ROWS"]),
        ("web/src/planted.ts", 'const AXES = ["x", "y"];\nconst ROW_COUNT = 5;\n  const MOST = 1;\n', []),
    ],
)
def test_a_constant_of_one_word_is_found(tmp_path: Path, file: str, text: str, names: list[str]) -> None:
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text(text)
    found = structure(tmp_path)
    assert found.returncode == 1 or not names
    assert idle_entries_left_out(found.stdout) == [
        f"{file}: {name} is one word: say what it holds, and in which unit" for name in names
    ]


# ---- paths in comments --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "text", "paths"),
    [
        ("server/planted.py", '"""As in lost.py, which ../server/planted.py was."""\n', ["lost.py"]),
        ("server/planted.py", 'MOST_M = 1\n"""Of spec/lost.md."""\n', ["spec/lost.md"]),
        ("server/planted.py", "# Read tests/lost/ and lost.ts first.\n", ["lost.ts", "tests/lost"]),
        ("server/planted.py", "NAMES = 'lost.py'  # https://example.org/lost.py, *.py, server/\n", []),
        ("web/src/planted.ts", "/**\n * As ../src/lost.ts,\n * not src/planted.ts.\n */\n", ["src/lost.ts"]),
        ("web/src/planted.ts", "f(1); // server/lost.py explains it\n", ["server/lost.py"]),
        ("web/src/planted.ts", 'f("./lost.ts", "https://server/lost.py"); // of three.js\n', []),
    ],
)
def test_a_path_in_a_comment_that_does_not_exist_is_found(
    tmp_path: Path, file: str, text: str, paths: list[str]
) -> None:
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text(text)
    found = structure(tmp_path)
    assert idle_entries_left_out(found.stdout) == [
        f"{file}: a comment names {name}, which does not exist" for name in paths
    ]


# ---- what nobody uses ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def python_sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    parts = (
        "precompute",
        "server",
        "scripts",
        "tests",
        "spec/player",
        "docs/examples",
        "docs/_site",
        "setup.py",
        "pyproject.toml",
    )
    return copied(parts, tmp_path_factory.mktemp("python"))


EXPORTED_ONLY = {
    "precompute/galewood/wood/species.py": "def planted_oak(): ...",
    "precompute/galewood/wood/__init__.py": "from galewood.wood.species import planted_oak\n"
    "__all__ = ['planted_oak']",
}


@pytest.mark.parametrize(
    ("files", "unused"),
    [
        ({"precompute/galewood/wood/planted.py": "def planted_oak(): ..."}, ["planted_oak"]),
        ({"server/galewood_server/ops/planted.py": "class PlantedMeter: ..."}, ["PlantedMeter"]),
        ({"tests/package/planted.py": "PLANTED_OAK = 1"}, ["PLANTED_OAK"]),
        ({"tests/package/planted.py": "def planted_oak(): ...\n\nplanted_oak()"}, []),
        (EXPORTED_ONLY, ["planted_oak"]),
    ],
)
def test_an_unused_name_is_found(python_sources: Path, files: dict[str, str], unused: list[str]) -> None:
    paths = {python_sources / name: text for name, text in files.items()}
    before = {path: path.read_text() if path.exists() else "" for path in paths}
    try:
        for path, text in paths.items():
            path.write_text(f"{before[path]}\n{text}\n")
        found = checked([VULTURE], python_sources)
    finally:
        for path, text in before.items():
            path.write_text(text)
    assert found.returncode == (3 if unused else 0), found.stdout
    assert [line.split("'")[1] for line in found.stdout.splitlines()] == unused


@pytest.mark.parametrize(
    "package",
    [
        {"__init__.py": "used = unused = 1\n__all__ = ['used', 'unused']\n"},
        {
            "__init__.py": "",
            "__init__.pyi": "from .elm import used as used\nfrom .elm import unused as unused\n",
        },
    ],
    ids=["__all__", "stub"],
)
def test_a_name_that_no_other_package_imports_is_found(tmp_path: Path, package: dict[str, str]) -> None:
    library = tmp_path / "precompute" / "galewood"
    for name in ("wind", "wood"):
        (library / name).mkdir(parents=True)
    for file, text in package.items():
        (library / "wood" / file).write_text(text)
    (library / "wood" / "oak.py").write_text("from galewood.wood import unused\n")
    (library / "wind" / "gusts.py").write_text("from galewood.wood import used\n")
    found = structure(tmp_path)
    assert found.returncode == 1
    assert idle_entries_left_out(found.stdout) == [
        "galewood.wood exports unused, which no other package imports: do not export it"
    ]


def test_an_unused_export_or_file_is_found(tmp_path: Path) -> None:
    root_files = ("package.json", "knip.jsonc", "tsconfig.json", "vitest.config.ts")
    copied((*root_files, "web", "tools", "tests/web", "tests/tools", "tests/e2e"), tmp_path)
    (tmp_path / "node_modules").symlink_to(REPOSITORY / "node_modules")
    unused: list[str | Path] = ["npm", "run", "--silent", "unused"]
    found = checked(unused, tmp_path)
    assert found.returncode == 0, found.stdout + found.stderr
    for file in ("web/src/page/planted.ts", "web/player/src/core/planted.ts"):
        (tmp_path / file).write_text("export const used = 1;\nexport const plantedExport = used;\n")
    (tmp_path / "web" / "src" / "page" / "plantedFile.ts").write_text("export const nobody = 1;\n")
    test = tmp_path / "tests" / "web" / "planted.test.ts"
    test.write_text(
        'import { used } from "../../web/src/page/planted";\n'
        'import { used as other } from "../../web/player/src/core/planted";\n'
        "console.log(used, other);\n"
    )
    found = checked(unused, tmp_path)
    assert found.returncode == 1
    words = found.stdout.split()
    assert "web/src/page/plantedFile.ts" in words
    assert words.count("plantedExport") == 2 and "used" not in words, found.stdout
