"""On-disk cache of tetrahedral meshes, keyed by the hash of their input."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from galewood.util import Floats, Int32s, Ints, write_arrays

RECIPE_VERSION = 7  # increase it when the recipe changes, to invalidate cached meshes


def cache_key(vertices: Floats, faces: Ints, target_tets: int) -> str:
    """SHA-256 of the wood surface and the settings."""
    digest = hashlib.sha256(f"{RECIPE_VERSION} {target_tets} ".encode())
    digest.update(np.ascontiguousarray(vertices, dtype="<f8").tobytes())
    digest.update(np.ascontiguousarray(faces, dtype="<i4").tobytes())
    return digest.hexdigest()


def cached_path(folder: Path, key: str) -> Path:
    """Path of the cached mesh for a key."""
    return folder / f"tets-{key}.npz"


def load_cached(folder: Path | None, key: str) -> tuple[Floats, Int32s, Floats, dict[str, Any]] | None:
    """(vertices, tets, radius ratio, report), or None if there is no readable file."""
    path = None if folder is None else cached_path(folder, key)
    if path is None or not path.exists():
        return None
    try:
        with np.load(path, allow_pickle=False) as data:
            report = json.loads(bytes(data["report"]).decode())
            return data["vertices"], data["tets"], data["radius_ratio"], report
    except (OSError, ValueError, KeyError, EOFError):
        return None  # a damaged file is treated as missing and computed again


def store_cached(
    folder: Path | None, key: str, vertices: Floats, tets: Ints, radius_ratio: Floats, report: dict[str, Any]
) -> None:
    """Store a mesh atomically; does nothing without a folder."""
    if folder is None:
        return
    text = np.frombuffer(json.dumps(report).encode(), dtype=np.uint8)
    path = cached_path(folder, key)
    write_arrays(path, vertices=vertices, tets=tets, radius_ratio=radius_ratio, report=text)
