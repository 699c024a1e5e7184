"""Fitted tables, kept in the cache: a build that is resumed after its table does not fit it again."""

from __future__ import annotations

import hashlib
import json
import zipfile
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from galewood.pipeline.reduction import Subspace
from galewood.pipeline.tables import DefaultPart
from galewood.table import TableError, decode, encode
from galewood.util import write_arrays
from galewood.versions import sources_hash


@dataclass(frozen=True)
class KeptFit:
    """A fitted table and its file."""

    part: DefaultPart
    table: bytes

    @classmethod
    def of(cls, part: DefaultPart) -> KeptFit:
        """The fit of a table that was just made."""
        return cls(part, encode(part.table))


def fit_path(cache_dir: Path, *inputs: object) -> Path:
    """Where the fit of these inputs is kept: JSON-able values that decide the table."""
    text = json.dumps([sources_hash(), *inputs], sort_keys=True)
    return cache_dir / "fits" / f"{hashlib.sha256(text.encode()).hexdigest()}.npz"


def keep_fit(path: Path, fit: KeptFit) -> None:
    """Write a fit atomically."""
    write_arrays(path, table=np.frombuffer(fit.table, np.uint8), **vars(fit.part.subspace))


def kept_fit(path: Path) -> KeptFit | None:
    """The fit that was kept; None: there is none, or it is damaged."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = [file[field.name] for field in fields(Subspace)]
            table = file["table"].tobytes()
        subspace: list[Any] = [array if array.ndim else float(array) for array in arrays]
        return KeptFit(DefaultPart(decode(table), Subspace(*subspace)), table)
    except (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile, TableError):
        return None
