"""Paths that comments and docstrings name, for scripts/structure.py: they must follow a file that moves."""

from __future__ import annotations

import ast
import io
import os
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

from scripts.sources import SKIPPED_FOLDERS, SOURCE_FOLDERS, TYPESCRIPT_SUFFIXES, sources

NAMED_FOLDERS = (*SOURCE_FOLDERS, "assets", "deploy")
"""A path that begins with one of these is checked whatever it ends with, others if they end like a source."""

# neither in the middle of a word or an address, nor after a placeholder
PATH_PATTERN = re.compile(
    r"(?<![\w./:@~*<>{}$-])(?:\.{1,2}/)*"
    rf"((?:{'|'.join(NAMED_FOLDERS)})/[\w./-]*\w|(?:[\w-][\w.-]*/)*[\w-][\w.-]*\.(?:pyi?|tsx?|mjs|md)(?![\w/-]))"
)
TYPESCRIPT_COMMENT = re.compile(r"(?:^|(?<=\s))(?://[^\n]*|/\*.*?\*/)", re.MULTILINE | re.DOTALL)


def missing_paths(root: Path) -> list[str]:
    """A sentence for each path in a comment of a source that no path of a file or folder ends with."""
    known = set(_endings(root))
    return [
        f"{source.relative_to(root).as_posix()}: a comment names {path}, which does not exist"
        for source in sources(root)
        for path in sorted({path for text in _comments(source) for path in PATH_PATTERN.findall(text)})
        if path not in known
    ]


def _endings(root: Path) -> Iterator[str]:
    """Every way to name a file or folder of the project: its path, and the ends of its path."""
    names = [path.name for path in root.iterdir() if path.is_file()]
    for name in NAMED_FOLDERS:
        for folder, folders, files in os.walk(root / name):
            folders[:] = [one for one in folders if one not in SKIPPED_FOLDERS]
            inside = Path(folder).relative_to(root).as_posix()
            names += [inside, *(f"{inside}/{file}" for file in files)]
    for name in names:
        parts = name.split("/")
        yield from ("/".join(parts[first:]) for first in range(len(parts)))


def _comments(source: Path) -> Iterator[str]:
    """The comments of a source, and the docstrings of a Python module."""
    text = source.read_text(encoding="utf-8")
    if source.suffix in TYPESCRIPT_SUFFIXES:
        yield from TYPESCRIPT_COMMENT.findall(text)
        return
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.string
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            yield str(node.value.value)
