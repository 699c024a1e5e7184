"""Files that other programs read: they agree with each other, and with what the repository contains."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import galewood
import griffe
import yaml

REPOSITORY = Path(__file__).resolve().parents[2]


def text(name: str) -> str:
    return (REPOSITORY / name).read_text()


def document(name: str) -> Any:
    return yaml.safe_load(text(name))


PROJECT: dict[str, Any] = tomllib.loads(text("pyproject.toml"))["project"]


def test_the_version_is_the_same_everywhere() -> None:
    citation = document("CITATION.cff")
    wheel = re.search(r"galewood-([\d.]+)-py3-none-any\.whl", text("README.md"))
    image = re.search(r"image: galewood:(\S+)", text("docker-compose.yml"))
    assert wheel and image
    versions = {
        "web/package.json": json.loads(text("web/package.json"))["version"],
        "web/player/package.json": json.loads(text("web/player/package.json"))["version"],
        "web/trees/package.json": json.loads(text("web/trees/package.json"))["version"],
        "web/trees/README.md": re.findall(r"galewood-trees-([\d.]+)\.tgz", text("web/trees/README.md"))[-1],
        "CITATION.cff": citation["version"],
        "README.md": wheel[1],
        "docker-compose.yml": image[1],
    }
    assert versions == dict.fromkeys(versions, PROJECT["version"])
    assert citation["license"] == PROJECT["license"]


def test_hooks_run_what_is_installed_here() -> None:
    for repository in document(".pre-commit-config.yaml")["repos"]:
        assert repository["repo"] == "local"
        for hook in repository["hooks"]:
            program, *arguments = hook["entry"].split()
            assert hook["language"] == "system"
            assert program.startswith(".venv/bin/") or program == "npm"
            for name in [word for word in arguments if word.endswith(".py")]:
                assert (REPOSITORY / name).is_file()


def test_the_workflow_runs_what_ci_runs_with_actions_that_cannot_change() -> None:
    steps = document(".github/workflows/ci.yml")["jobs"]["tests"]["steps"]
    assert [step["run"] for step in steps if "run" in step] == [".ci/run"]
    used = [step["uses"] for step in steps if "uses" in step]
    assert used and all(re.fullmatch(r"actions/[a-z-]+@[0-9a-f]{40}", one) for one in used)


def test_the_development_container_has_the_python_of_the_image() -> None:
    (base,) = re.findall(r"^FROM (python\S+)$", text(".devcontainer/Dockerfile"), re.MULTILINE)
    assert f"FROM {base}" in text("Dockerfile")
    assert json.loads(text(".devcontainer/devcontainer.json"))["build"] == {"dockerfile": "Dockerfile"}


def mkdocstrings_settings() -> dict[str, Any]:
    """The settings of mkdocstrings' Python handler. MkDocs' own tags are not for a plain YAML loader."""
    (block,) = re.findall(r"(?ms)^  - mkdocstrings:\n(.*?)\n\n", text("mkdocs.yml"))
    return yaml.safe_load(block)["handlers"]["python"]


def test_the_reference_of_the_library_describes_every_public_name() -> None:
    extension = mkdocstrings_settings()["options"]["extensions"][0]
    package = griffe.load(
        "galewood",
        search_paths=[str(REPOSITORY / "precompute")],
        extensions=griffe.load_extensions(str(REPOSITORY / extension)),
    )
    described = {name for name, member in package.members.items() if member.is_exported}
    assert described == set(dir(galewood))
