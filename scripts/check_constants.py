"""Part of `make check`: fails if a file of constants is stale, or if a module types a shared constant."""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from scripts.write_constants import ROOT, SOURCE_FILE, generated, read_groups

SEARCHED_FOLDERS = (("precompute", ".py"), ("server", ".py"), ("web", ".ts"), ("tools", ".ts"))
"""Folders in which no shared constant is typed, and the ending of their modules."""
BUILT_FOLDERS = {"node_modules", "dist", "__pycache__"}
COINCIDENCES: Mapping[str, str] = {
    "ROUND_COUNT": "of an iteration; of a benchmark",
    "VERSION": "of the format that the module writes",
}
"""Names with the same value in both languages that mean different things there, and what they mean."""


@dataclass(frozen=True)
class Declaration:
    """A constant that a module types."""

    place: str
    python: bool
    name: str
    """Without leading underscores."""
    value: object
    """None: not an expression of numbers and texts."""


def findings(root: Path) -> list[str]:
    """What is wrong, a line each."""
    files = generated(root)
    stale = [path for path, text in files.items() if _text(root / path) != text]
    modules = {path: text for path, text in _modules(root).items() if path not in files}
    declared = [one for path, text in modules.items() for one in declarations(path, text)]
    shared = [name for group in read_groups(root).values() for name in group]
    return [
        *(f"{path}: stale; run `make constants`" for path in stale),
        *(f"{one.place}: {one.name} is shared: import it" for one in declared if one.name in shared),
        *_typed_twice(declared),
        *_used_once(shared, modules),
    ]


def _typed_twice(declared: list[Declaration]) -> Iterator[str]:
    """Constants that have the same name and value in both languages."""
    python = {(one.name, one.value): one.place for one in declared if one.python and one.value is not None}
    for one in declared:
        other = python.get((one.name, one.value))
        if not one.python and other and one.name not in COINCIDENCES:
            yield f"{one.place}: {one.name} is typed in {other} too: move it to {SOURCE_FILE}, or rename it"


def _used_once(shared: list[str], modules: Mapping[str, str]) -> Iterator[str]:
    """Shared constants that one of the languages does not use."""
    for ending, language in ((".py", "Python"), (".ts", "TypeScript")):
        text = "\n".join(text for path, text in modules.items() if path.endswith(ending))
        words = set(re.findall(r"\b[A-Z][A-Z0-9_]+\b", text))
        unused = [name for name in shared if name not in words]
        yield from (f"{SOURCE_FILE}: {name} is not used in {language}" for name in unused)


def _modules(root: Path) -> dict[str, str]:
    """The text of every module in the searched folders by its path."""
    found: dict[str, str] = {}
    for folder, ending in SEARCHED_FOLDERS:
        for parent, folders, names in os.walk(root / folder):
            folders[:] = sorted(set(folders) - BUILT_FOLDERS)
            for path in (Path(parent, name) for name in sorted(names) if name.endswith(ending)):
                found[path.relative_to(root).as_posix()] = path.read_text(encoding="utf-8")
    return found


def _text(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.is_file() else None


_LITERAL = r"(?:\s*:[^=\n]+)?\s*=\s*(?=[-+\d(\[{\"'`])(.+)$"
_DECLARATION = {
    ".py": re.compile(r"^[ \t]*([A-Z_][A-Z0-9_]*(?:, ?[A-Z_][A-Z0-9_]*)*)" + _LITERAL, re.MULTILINE),
    ".ts": re.compile(r"\b(?:const|let|static|readonly) ([A-Z_][A-Z0-9_]*)" + _LITERAL, re.MULTILINE),
}


def declarations(path: str, text: str) -> Iterator[Declaration]:
    """The constants that a module types; what it derives or imports is none of them."""
    for found in _DECLARATION[path[-3:]].finditer(text):
        place = f"{path}:{text.count(chr(10), 0, found.start()) + 1}"
        names, value = found[1].replace(" ", "").split(","), plain_value(found[2])
        values = value if len(names) > 1 and isinstance(value, tuple) else (value,) * len(names)
        for one, own in zip(names, cast(tuple[object, ...], values), strict=False):
            yield Declaration(place, path.endswith(".py"), one.lstrip("_"), own)


_PLAIN = (
    *(ast.Expression, ast.Constant, ast.Tuple, ast.List, ast.expr_context),
    *(ast.UnaryOp, ast.BinOp, ast.operator, ast.unaryop),
)


def plain_value(text: str) -> object:
    """The value of an expression of numbers and texts, which both languages write alike; otherwise None."""
    text = re.split(r"\s(?:#|//)|;|\sas const\b", text)[0].strip().rstrip(",")
    try:
        tree = ast.parse(text, mode="eval")
        if not all(isinstance(node, _PLAIN) for node in ast.walk(tree)):
            return None
        value: object = eval(compile(tree, "<constant>", "eval"), {"__builtins__": {}})
    except (SyntaxError, TypeError, ValueError, ArithmeticError):
        return None
    return _frozen(value)


def _frozen(value: object) -> object:
    if isinstance(value, list | tuple):
        return tuple(_frozen(part) for part in cast(list[object], value))
    return value


if __name__ == "__main__":
    wrong = findings(ROOT)
    print("\n".join(wrong) or "The shared constants are typed once.")
    sys.exit(bool(wrong))
