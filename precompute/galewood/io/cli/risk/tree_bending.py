"""What the commands that bend trees share."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from galewood.io.cli.tools import print_warning, progress_bar, progress_reporter
from galewood.options import BuildRequest

if TYPE_CHECKING:  # loaded only by the commands that need it
    from galewood.io.api import Tree
    from galewood.solid.strain import CriticalWind, TreeStrain

OF_TREE = ("species", "height_m", "dbh_cm", "min_radius_mm", "up_axis")
FOLIAGE_NAMES = {"leaf": "in leaf", "bare": "bare"}
UNCHANGED_WEIGHT = 0.95
"""Share of the weight below which a warning says that it was changed, as in the report of a build."""


def read_tree(path: Path, options: BuildRequest) -> Tree:
    """The tree of a mesh or a scan. MeshError."""
    from galewood.io.api import read

    given = {name: getattr(options, name) for name in OF_TREE}
    return read(path, **given)


@contextmanager
def progress_of(what: str) -> Generator[Callable[[float], None]]:
    """A live bar; receives the share done."""
    with progress_bar() as bar:
        report = progress_reporter(bar)
        report(0.0, what)
        yield lambda share: report(share, what)


def print_weight(found: CriticalWind | TreeStrain) -> None:
    """Say if only a part of the weight acts."""
    if found.weight_share < UNCHANGED_WEIGHT:
        print_warning(
            f"The tree bears {found.load_factor:.0%} of its buckling load; few real trees bear more than a "
            f"third. So only {found.weight_share:.0%} of its weight acts. Check radii, height and leaves."
        )
