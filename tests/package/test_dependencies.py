"""What the packages import is what pyproject.toml declares, and what the locked requirements hold."""

from __future__ import annotations

import ast
import json
import re
import sys
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageMetadata, metadata, packages_distributions
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

REPOSITORY = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]
SOURCES = {
    "galewood": REPOSITORY / "precompute/galewood",
    "galewood_server": REPOSITORY / "server/galewood_server",
}
NEVER_IMPORTED = {"pyvista": "pytetwild imports it but declares it as an extra"}
# compiled modules without any Python file, which importlib.metadata does not attribute before Python 3.12
COMPILED = {"OpenEXR": ["openexr"]}
# files that are loaded only where an extra is installed
OF_EXTRAS = {"precompute/galewood/io/notebook/widget.py": "notebook"}
BUILD_TOOLS = {"setuptools", "wheel"}
IMPORTING_CALLS = {"import_module", "find_spec"}
LICENCES = re.compile("BSD|MIT|Apache|ISC|PSF-2.0|Python Software Foundation|MPL|LGPL-3.0-only")
"""Those that NOTICE names for what is installed at run time."""
UNSTATED_LICENCES = {"assimp-py", "openexr"}


@dataclass(frozen=True)
class Import:
    """A module that a file imports; `always`: as soon as the file itself is imported."""

    module: str
    always: bool
    where: str

    @property
    def file(self) -> str:
        return self.where.partition(":")[0]


def declared(*extras: str) -> dict[str, Requirement]:
    """The requirements of the library, or those of extras, by their normal names."""
    texts = [text for extra in extras for text in PROJECT["optional-dependencies"][extra]]
    requirements = [Requirement(text) for text in (texts if extras else PROJECT["dependencies"])]
    return {canonicalize_name(one.name): one for one in requirements}


def listed(name: str) -> set[str]:
    """The names of a list of requirements: those of its own lines."""
    lines = (REPOSITORY / "requirements" / name).read_text().splitlines()
    return {canonicalize_name(Requirement(line).name) for line in lines if line and line[0] not in "#-"}


def locked(lock: str) -> dict[str, str]:
    """The exact version of every package of a lock file."""
    text = (REPOSITORY / "requirements" / lock).read_text()
    return {canonicalize_name(name): version for name, version in re.findall(r"(?m)^(\S+)==(\S+)", text)}


def names_of(node: ast.AST) -> list[str]:
    """The modules that one statement or call imports, relative imports left out."""
    match node:
        case ast.Import(names=names):
            return [alias.name for alias in names]
        case ast.ImportFrom(module=str(module), level=0):
            return [module]
        case ast.Call(func=ast.Name(id=name), args=[ast.Constant(value=str(module)), *_]) if (
            name in IMPORTING_CALLS
        ):
            return [module]
        case ast.Call(
            func=ast.Name(id=name), args=[ast.JoinedStr(values=[ast.Constant(value=str(start)), *_]), *_]
        ) if name in IMPORTING_CALLS:
            return [start.rstrip(".")]
        case _:
            return []


def is_for_types(node: ast.AST) -> bool:
    """`if TYPE_CHECKING:`, which is never run."""
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def walked(node: ast.AST, always: bool = True) -> Iterator[tuple[ast.AST, bool]]:
    """Every node that can be run, and whether it is outside of any function."""
    for child in ast.iter_child_nodes(node):
        if is_for_types(child):
            continue
        inside = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        yield child, always
        yield from walked(child, always and not inside)


@cache
def third_party(package: str) -> list[Import]:
    """What a package imports from other people, wherever in its files."""
    own = {*SOURCES, *sys.stdlib_module_names}
    found: list[Import] = []
    for path in sorted(SOURCES[package].rglob("*.py")):
        for node, always in walked(ast.parse(path.read_text())):
            modules = {name.partition(".")[0] for name in names_of(node)} - own
            where = f"{path.relative_to(REPOSITORY)}:{getattr(node, 'lineno', 0)}"
            found += [Import(module, always, where) for module in modules]
    return found


@cache
def installed() -> Mapping[str, list[str]]:
    """What brings each module that can be imported here."""
    return {**COMPILED, **packages_distributions()}


def distributions(found: Import) -> set[str]:
    """The packages that bring a module, as they are installed here."""
    brought = installed().get(found.module, [])
    assert brought, f"{found.where}: {found.module} is not installed, so nobody knows what brings it"
    return {canonicalize_name(name) for name in brought}


def undeclared(imports: list[Import], known: dict[str, Requirement]) -> list[str]:
    return [f"{one.where} imports {one.module}" for one in imports if not distributions(one) & known.keys()]


def test_the_library_declares_all_that_it_imports() -> None:
    always = [one for one in third_party("galewood") if one.always and one.file not in OF_EXTRAS]
    lazily = [one for one in third_party("galewood") if not one.always]
    assert undeclared(always, declared()) == []
    # rival programs are held against ours where somebody has installed them; USD is large, so an extra
    assert undeclared(lazily, declared() | declared("rivals", "usd", "notebook")) == []
    for file, extra in OF_EXTRAS.items():
        of_extra = [one for one in third_party("galewood") if one.file == file]
        assert of_extra and undeclared(of_extra, declared() | declared(extra)) == []


def test_the_service_declares_all_that_it_imports() -> None:
    always = [one for one in third_party("galewood_server") if one.always]
    lazily = [one for one in third_party("galewood_server") if not one.always]
    assert undeclared(always, declared() | declared("server")) == []
    assert undeclared(lazily, declared() | declared("server", "distributed")) == []


def test_nothing_is_declared_that_is_not_used() -> None:
    of_library = {name for one in third_party("galewood") for name in distributions(one)}
    of_service = {name for one in third_party("galewood_server") for name in distributions(one)}
    assert declared().keys() - of_library - NEVER_IMPORTED.keys() == set()
    assert declared("rivals", "usd", "notebook").keys() - of_library == set()
    assert declared("server", "distributed").keys() - of_service - NEVER_IMPORTED.keys() == set()
    assert NEVER_IMPORTED.keys() & (of_library | of_service) == set()
    assert "networkx" not in declared() | declared("server", "distributed", "rivals")


def test_nothing_is_declared_twice() -> None:
    assert declared().keys() & declared("server", "distributed", "rivals", "usd", "notebook").keys() == set()
    assert declared("server").keys() & declared("distributed").keys() == set()


def test_the_list_of_requirements_is_what_is_declared() -> None:
    everything = declared() | declared("server", "distributed")
    assert listed("base.in") == everything.keys() | BUILD_TOOLS
    assert declared("rivals", "usd", "notebook").keys() <= listed("dev.in")


def test_locked_versions_are_within_the_declared_ranges() -> None:
    versions = locked("base.txt") | locked("dev.txt")
    extras = declared("server", "distributed", "rivals", "usd", "notebook")
    for name, requirement in (declared() | extras).items():
        assert requirement.specifier.contains(versions[name]), f"{requirement}, locked {versions[name]}"


def noted(*headings: str) -> set[str]:
    """The packages that NOTICE names below headings: the first word of each entry."""
    sections = re.findall(r"(?m)^(\w.*)\n((?:  .*\n)+)", (REPOSITORY / "NOTICE").read_text())
    texts = [
        text.partition("and their dependencies")[0] for name, text in sections if name.startswith(headings)
    ]
    entries = re.sub(r"\([^()]*\)|in the examples of the package galewood:", ",", ",".join(texts))
    words = [entry.split() for entry in re.split(r",| and ", entries)]
    return {canonicalize_name(word[0]) if word[0][0] != "@" else word[0] for word in words if word}


def licence(found: PackageMetadata) -> str:
    """What a package says about its licence: an SPDX expression, or else its classifiers, or else a text."""
    classifiers = [one for one in found.get_all("Classifier") or [] if one.startswith("License ::")]
    fields = found.get_all("License-Expression") or classifiers or found.get_all("License") or []
    return " ".join(fields)


def javascript(*kinds: str) -> set[str]:
    """The direct dependencies of page, player, generator and tests; three-186 is an older three."""
    root = json.loads((REPOSITORY / "package.json").read_text())
    folders = [REPOSITORY / name for name in root["workspaces"]]
    manifests = [root, *(json.loads((folder / "package.json").read_text()) for folder in folders)]
    names = {name for manifest in manifests for kind in kinds for name in manifest.get(kind, {})}
    return {re.sub(r"^three-\d+$", "three", name) for name in names} - {"galewood"}


def test_the_notice_names_every_dependency() -> None:
    ours = {name for path in REPOSITORY.glob("requirements/*.in") for name in listed(path.name)}
    every_lock = [locked(path.name) for path in REPOSITORY.glob("requirements/*.txt")]
    assert (ours | declared().keys()) - noted("Python") == set()
    assert (noted("Python") - {name for lock in every_lock for name in lock}) == set()
    assert javascript("dependencies", "devDependencies") - noted("JavaScript") == set()
    assert javascript("dependencies") - noted("JavaScript, in the page") == set()


def test_the_licences_at_run_time_are_those_of_the_notice() -> None:
    found = {name: licence(metadata(name)) for name in locked("base.txt") if name not in UNSTATED_LICENCES}
    assert {name: text for name, text in found.items() if not LICENCES.search(text)} == {}
