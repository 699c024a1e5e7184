"""The modules of OpenUSD, which are an optional and untyped dependency."""

from __future__ import annotations

from importlib import import_module
from types import SimpleNamespace
from typing import Any

from galewood.io.export.errors import ExportError

MODULES = ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdShade", "UsdSkel", "Vt")


def usd_library() -> Any:
    """``Gf``, ``Usd`` and the other modules, as attributes. Raises ExportError where usd-core is missing."""
    try:
        import_module("pxr")
    except ImportError:
        raise ExportError("USD needs the package usd-core: pip install 'galewood[usd]'") from None
    return SimpleNamespace(**{name: import_module(f"pxr.{name}") for name in MODULES})
