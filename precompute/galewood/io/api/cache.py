"""Where the library keeps meshes and training runs between builds."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

import os
from pathlib import Path

from platformdirs import user_cache_path


def default_cache_dir() -> Path:
    """GALEWOOD_CACHE_DIR if set, else the user's cache folder (on Linux ~/.cache/galewood)."""
    given = os.environ.get("GALEWOOD_CACHE_DIR")
    return Path(given) if given else user_cache_path("galewood", appauthor=False)
