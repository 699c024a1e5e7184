"""Rules on the sources that no linter has: python -m scripts.structure [FOLDER], part of `make check`.

- A folder holds at most 15 source files, and a Python function takes at most 9 parameters. What exceeds a
  limit is listed here by name, with the number that it must not exceed; an entry that is no longer needed
  fails as well, so the lists only become shorter.
- What a Python package exports, in ``__all__`` or in its stub ``__init__.pyi``, another one imports. (vulture
  finds what nobody uses at all.)
- The name of a module's constant has two words, such as MAX_ROUNDS; one that lists things may be a plural.
- A file or folder that a comment or docstring names exists (scripts/written_paths.py).
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import zip_longest
from pathlib import Path

from scripts.sources import is_python, sources
from scripts.written_paths import missing_paths

REPOSITORY = Path(__file__).resolve().parents[1]
LIBRARIES = {"precompute": "galewood", "server": "galewood_server"}
"""Python packages that are divided into packages, by the folder that they are in."""

MOST_FILES = 15
CROWDED_FOLDERS: dict[str, int] = {}

MOST_PARAMETERS = 9
LONG_SIGNATURES: dict[str, int] = {
    # kernels of the finite elements: a change of their compiled code could change the last bits of results
    "precompute/galewood/solid/fem/elements/assembly.py:_assemble10": 20,
    "precompute/galewood/solid/fem/elements/linear_batches.py:_assemble": 14,
}


CONSTANT_ROOTS = ("precompute", "server", "scripts", "web", "tools")
CLEAR_NAMES = {"FORMAT", "JIT", "MAGIC", "PACKAGE", "REPOSITORY", "ROOT", "SIOCOUTQNSD", "VERSION"}
"""Constants of one word that say what they are."""
TYPESCRIPT_CONSTANT = re.compile(r"^(?:export )?const ([A-Z][A-Z0-9]*)\b(?:: [^=]*)? = ?(.*)$", re.MULTILINE)
NUMBER_PATTERN = re.compile(r"[-+(]*(?:\d|Math\.|[A-Z][A-Z_0-9]* [-+*/%])")


def files_by_folder(root: Path) -> Counter[str]:
    """The number of source files in each folder, relative to the root."""
    return Counter(path.parent.relative_to(root).as_posix() for path in sources(root))


def parsed(root: Path) -> dict[Path, ast.Module]:
    """The Python files, relative to the root, and the stubs of packages."""
    paths = [path for path in sources(root) if is_python(path)]
    stubs = [path.with_suffix(".pyi") for path in paths if path.name == "__init__.py"]
    paths += [path for path in stubs if path.exists()]
    return {path.relative_to(root): ast.parse(path.read_bytes()) for path in paths}


def parameters_by_function(modules: Mapping[Path, ast.Module]) -> dict[str, int]:
    """The number of parameters of each function, as FILE:CLASS.NAME, without ``self`` and ``cls``."""
    return {
        name: count
        for path, module in modules.items()
        for name, count in _parameters(module, f"{path.as_posix()}:")
    }


def _parameters(node: ast.AST, prefix: str) -> Iterator[tuple[str, int]]:
    for child in ast.iter_child_nodes(node):
        name = prefix
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            named = [*child.args.posonlyargs, *child.args.args, *child.args.kwonlyargs]
            yield prefix + child.name, sum(one.arg not in ("self", "cls") for one in named)
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name = f"{prefix}{child.name}."
        yield from _parameters(child, name)


def unused_exports(modules: Mapping[Path, ast.Module]) -> list[str]:
    """A sentence for each name that a package exports and no file outside it imports."""
    exported, imported = dict[str, list[str]](), defaultdict[str, set[str]](set)
    for path, module in modules.items():
        package = _package_of(path)
        for node in ast.walk(module):
            if isinstance(node, ast.ImportFrom):
                origin = _origin(node, path)
                if origin != package:
                    imported[origin].update(alias.name for alias in node.names)
        if path.stem == "__init__" and package == ".".join(path.parts[1:-1]):
            exported.setdefault(package, []).extend(_exports_of(module, path))
    return [
        f"{package} exports {name}, which no other package imports: do not export it"
        for package, names in exported.items()
        for name in names
        if name not in imported[package]
    ]


def _package_of(path: Path) -> str:
    """``galewood.solid.fem`` for its files; "" for files of no such package."""
    if len(path.parts) < 4 or LIBRARIES.get(path.parts[0]) != path.parts[1]:
        return ""
    return ".".join(path.parts[1 : 4 if ".".join(path.parts[1:3]) in _package_groups() else 3])


@cache
def _package_groups() -> set[str]:
    """Packages whose packages count as packages of their own, from the import contract on public names."""
    settings = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    return next(set(contract["groups"]) for contract in contracts if contract["id"] == "public-names")


def _origin(node: ast.ImportFrom, path: Path) -> str:
    """The module that a file imports from; "" if it is not below the file's own package."""
    inside = ".".join(path.parts[1:-1]) if node.level else ""
    return ".".join(part for part in (inside, node.module) if part) if node.level < 2 else ""


def _exports_of(module: ast.Module, path: Path) -> list[str]:
    """The names that a stub imports, or the strings in ``__all__``."""
    if path.suffix == ".pyi":
        imports = [node for node in module.body if isinstance(node, ast.ImportFrom)]
        return [alias.name for node in imports for alias in node.names]
    for node in module.body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return list(ast.literal_eval(node.value))
    return []


def vague_constants(root: Path, modules: Mapping[Path, ast.Module]) -> list[str]:
    """A sentence for each module constant of one word that is a number or no plural."""
    constants = {path: list(_python_constants(module)) for path, module in modules.items()}
    for path in sources(root):
        if path.suffix == ".ts":
            found = TYPESCRIPT_CONSTANT.findall(path.read_text(encoding="utf-8"))
            constants[path.relative_to(root)] = [
                (name, bool(NUMBER_PATTERN.match(text))) for name, text in found
            ]
    return [
        f"{path.as_posix()}: {name} is one word: say what it holds, and in which unit"
        for path, names in constants.items()
        if path.parts[0] in CONSTANT_ROOTS
        for name, is_number in names
        if name not in CLEAR_NAMES and (is_number or not name.endswith("S"))
    ]


def _python_constants(module: ast.Module) -> Iterator[tuple[str, bool]]:
    """Names of one word that a module assigns, and whether a number is assigned."""
    for node in module.body:
        if isinstance(node, ast.Assign):
            targets, assigned = node.targets, node.value
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets, assigned = [node.target], node.value
        else:
            continue
        for target in targets:
            names = target.elts if isinstance(target, ast.Tuple) else [target]
            values = (
                assigned.elts
                if isinstance(target, ast.Tuple) and isinstance(assigned, ast.Tuple)
                else [assigned]
            )
            for name, value in zip_longest(names, values[: len(names)]):
                if isinstance(name, ast.Name) and re.fullmatch("[A-Z][A-Z0-9]*", name.id):
                    yield name.id, _is_number(value)


def _is_number(value: ast.expr | None) -> bool:
    """Whether an expression is a number, or computed from one."""
    if isinstance(value, ast.BinOp):
        return _is_number(value.left) or _is_number(value.right)
    if isinstance(value, ast.UnaryOp):
        return _is_number(value.operand)
    return isinstance(value, ast.Constant) and type(value.value) in (int, float)


def problems(what: str, found: Mapping[str, int], most: int, known: Mapping[str, int]) -> list[str]:
    """A sentence for each number above the limit or that of its known exception, and for each idle entry."""
    too_many = [
        f"{name}: {count} {what}, at most {known.get(name, most)}"
        for name, count in found.items()
        if count > known.get(name, most)
    ]
    idle = [
        f"{name}: {found.get(name, 0)} {what} are no exception any more: remove it from scripts/structure.py"
        for name in known
        if found.get(name, 0) <= most
    ]
    return too_many + idle


def main(root: Path) -> int:
    """Print every problem below a folder; the exit status."""
    modules = parsed(root)
    found = problems("source files", files_by_folder(root), MOST_FILES, CROWDED_FOLDERS)
    found += problems("parameters", parameters_by_function(modules), MOST_PARAMETERS, LONG_SIGNATURES)
    found += unused_exports(modules)
    found += vague_constants(root, modules)
    found += missing_paths(root)
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else REPOSITORY))
