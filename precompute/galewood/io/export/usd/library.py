"""The modules of OpenUSD, which are an optional and untyped dependency."""

from __future__ import annotations

from importlib import import_module
from types import SimpleNamespace
from typing import Any

MODULES = ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdShade", "UsdSkel", "Vt")


def usd_library() -> Any:
    """``Gf``, ``Usd`` and the other modules, as attributes."""
    return SimpleNamespace(**{name: import_module(f"pxr.{name}") for name in MODULES})
