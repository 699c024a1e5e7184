"""Packages that single kinds of export need, looked for before any work."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module

from galewood.io.export.errors import ExportError
from galewood.io.export.options import ExportOptions

PACKAGE_OF_USE = {"usd": ("pxr", "usd-core", "galewood[usd]"), "exr": ("OpenEXR", "openexr", "openexr")}
"""Module, its package, and what pip installs, of a kind of export or a format of its textures."""
EXR_KINDS: Mapping[str, frozenset[str]] = {"vat": frozenset({"exr"}), "pivots": frozenset({"exr", "png"})}
"""Kinds that write EXR files, by the formats of textures with which they do."""


def check_packages(kind: str, options: ExportOptions) -> None:
    """Raises ExportError, which says what to install, if a package is missing that an export will need."""
    uses = (kind, "exr") if options.format in EXR_KINDS.get(kind, ()) else (kind,)
    for module, package, installed in (PACKAGE_OF_USE[use] for use in uses if use in PACKAGE_OF_USE):
        try:
            import_module(module)
        except ImportError:
            what = f"the export {kind} needs the package {package}"
            raise ExportError(f"{what}: pip install '{installed}'") from None
