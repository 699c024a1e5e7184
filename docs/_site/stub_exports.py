"""Griffe extension: a package exports what its stub ``__init__.pyi`` imports, as lazy_loader reads it."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import griffe


class StubExports(griffe.Extension):
    """Griffe takes the exports from ``__all__``, which a lazy package computes."""

    def on_package(self, *, pkg: griffe.Module, **kwargs: Any) -> None:
        """Set the exports of a package that has a stub."""
        stub = Path(str(pkg.filepath)).with_suffix(".pyi")
        if stub.exists():
            imports = [
                node for node in ast.walk(ast.parse(stub.read_text())) if isinstance(node, ast.ImportFrom)
            ]
            pkg.exports = [alias.name for node in imports for alias in node.names]
