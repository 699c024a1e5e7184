"""A fitted table that is kept: found again as it was, and not if it is damaged or of other inputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from galewood.pipeline.reduction import Subspace
from galewood.pipeline.stages.kept_fit import KeptFit, fit_path, keep_fit, kept_fit
from galewood.pipeline.tables import DefaultPart
from galewood.table import decode, encode

from tests.golden import GOLDEN_FOLDER

TABLE = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())


def test_a_fit_is_found_again_as_it_was(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    subspace = Subspace(rng.normal(size=(5, 3, 4)), rng.normal(size=(4, 15)), rng.normal(size=4), 0.25, 1e-3)
    fit, path = KeptFit.of(DefaultPart(TABLE, subspace)), fit_path(tmp_path, ["run"], {"seed": 1})
    assert kept_fit(path) is None
    keep_fit(path, fit)
    found = kept_fit(path)
    assert found and found.table == fit.table == encode(found.part.table)
    for name, value in vars(subspace).items():
        assert np.array_equal(getattr(found.part.subspace, name), value), name
    assert fit_path(tmp_path, ["run"], {"seed": 2}) != path
    path.write_bytes(path.read_bytes()[:-20])
    assert kept_fit(path) is None
