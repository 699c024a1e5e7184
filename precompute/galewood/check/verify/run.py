"""Runs the checks of `galewood verify` and formats their results."""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from time import perf_counter
from typing import Any

from galewood.check.verify import (
    beam_checks,
    element_checks,
    motion_checks,
    pull_checks,
    shipped_checks,
    species_checks,
)
from galewood.check.verify.checks import Check
from galewood.check.verify.specimens import cached_mesher


@dataclass(frozen=True, kw_only=True)
class Scope:
    """Scope of the verification: elements, bars and poles; with `species_dir` also the trees in that folder.

    Their tetrahedral meshes are cached in `cache_dir`. With `shipped`, only the shipped tables of that folder
    are checked.
    """

    species_dir: Path | None = None
    cache_dir: Path = Path("data/cache")
    shipped: Path | None = None


def verify_table(scope: Scope, report: Callable[[Check], None] = lambda check: None) -> list[Check]:
    """Run all checks of the scope; `report` is called with each check when it is done."""
    if scope.shipped is not None:
        return _reported(shipped_checks.checks(scope.shipped), report)
    groups = [element_checks.checks(), beam_checks.checks(), motion_checks.checks(), pull_checks.checks()]
    if scope.species_dir is not None:
        groups.append(species_checks.checks(scope.species_dir, cached_mesher(scope.cache_dir)))
    return _reported(chain.from_iterable(groups), report)


def _reported(checks: Iterable[Check], report: Callable[[Check], None]) -> list[Check]:
    found: list[Check] = []
    for check in checks:
        found.append(check)
        report(check)
    return found


def run_checks(scope: Scope, report: Callable[[Check], None] = lambda check: None) -> dict[str, Any]:
    """Run all checks and return JSON-able results: passed, seconds, checks, and a Markdown table."""
    begin = perf_counter()
    checks = verify_table(scope, report)
    return {
        "passed": all(check.passed for check in checks),
        "seconds": perf_counter() - begin,
        "checks": [{**asdict(check), "passed": check.passed, "skipped": check.skipped} for check in checks],
        "markdown": markdown(checks),
    }


MARKERS = ("<!-- checks: written by `galewood verify --docs` -->", "<!-- end of checks -->")


def insert_table(page: str, table: str) -> str:
    """Return the page with the table inserted between its markers. Raises ValueError if there are none."""
    begin, end = (page.find(marker) for marker in MARKERS)
    if not 0 <= begin < end:
        raise ValueError(f"the page has no lines {MARKERS[0]!r} and {MARKERS[1]!r}")
    return page[: begin + len(MARKERS[0])] + f"\n{table}\n" + page[end:]


def markdown(checks: list[Check]) -> str:
    """Format the checks as the Markdown table of docs/physics.md."""
    lines = ["| check | exact | computed | deviation | limit | |", "|---|---|---|---|---|---|"]
    for check in checks:
        exact, computed = (_figure(value, check.unit) for value in (check.exact, check.computed))
        deviation = "" if check.deviation is None else f"{check.deviation:.2g}"
        note = f"; {check.note}" if check.note else ""
        lines.append(
            f"| {check.name} | {exact} | {computed} | {deviation} | {check.limit:g} | {check.state}{note} |"
        )
    return "\n".join(lines)


def _figure(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.5g} {unit}".removesuffix(" –")
