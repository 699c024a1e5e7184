"""The physics checks that `galewood verify` runs: exact value, computed value, deviation, limit."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from time import perf_counter
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Check:
    """One line of the table. `deviation` is relative (or the figure itself where the exact value is zero)."""

    name: str
    exact: float | None
    computed: float | None
    unit: str
    deviation: float | None
    limit: float
    note: str = ""

    @property
    def skipped(self) -> bool:
        """Whether the check could not run here (its note says why)."""
        return self.computed is None

    @property
    def passed(self) -> bool:
        """Whether the deviation keeps its limit; a skipped check does not fail."""
        return self.skipped or (self.deviation is not None and abs(self.deviation) <= self.limit)

    @property
    def state(self) -> str:
        """ "passed", "FAILED" or "skipped"."""
        return "skipped" if self.skipped else "passed" if self.passed else "FAILED"

    def line(self) -> str:
        """The check in one line of plain text."""
        deviation = "" if self.deviation is None else f", off {self.deviation:.2g} of {self.limit:g}"
        note = f" ({self.note})" if self.note else ""
        return f"{self.state}: {self.name}{deviation}{note}"


def relative(name: str, exact: float, computed: float, unit: str, limit: float, note: str = "") -> Check:
    """A check of a value against an exact one that is not zero."""
    deviation = computed / exact - 1
    return Check(
        name=name, exact=exact, computed=computed, unit=unit, deviation=deviation, limit=limit, note=note
    )


def absolute(name: str, computed: float, limit: float, note: str = "") -> Check:
    """A check of a ratio that should be zero."""
    return Check(
        name=name, exact=0.0, computed=computed, unit="–", deviation=computed, limit=limit, note=note
    )


def skipped(name: str, why: str) -> Check:
    """A check that cannot run here."""
    return Check(name=name, exact=None, computed=None, unit="–", deviation=None, limit=0.0, note=why)


@dataclass(frozen=True, kw_only=True)
class Scope:
    """What to check: without `species_dir` only bars, poles and elements; with it the grown trees as well, on
    meshes kept in `cache_dir`.
    """

    species_dir: Path | None = None
    cache_dir: Path = Path("data/cache")


def verify_table(scope: Scope, tell: Callable[[Check], None] = lambda check: None) -> list[Check]:
    """Run every check of the scope; `tell` hears of each as it ends."""
    from precompute import verify_beams, verify_elements, verify_motion

    groups = [verify_elements.checks(), verify_beams.checks(), verify_motion.checks()]
    if scope.species_dir is not None:
        from precompute import verify_species
        from precompute.verify_specimens import cached_mesher

        groups.append(verify_species.checks(scope.species_dir, cached_mesher(scope.cache_dir)))
    found: list[Check] = []
    for check in chain.from_iterable(groups):
        found.append(check)
        tell(check)
    return found


def run_checks(scope: Scope, tell: Callable[[Check], None] = lambda check: None) -> dict[str, Any]:
    """All checks as JSON-able figures: whether all passed, seconds, the lines, and the same as Markdown."""
    begin = perf_counter()
    checks = verify_table(scope, tell)
    return {
        "passed": all(check.passed for check in checks),
        "seconds": perf_counter() - begin,
        "checks": [{**asdict(check), "passed": check.passed, "skipped": check.skipped} for check in checks],
        "markdown": markdown(checks),
    }


MARKERS = ("<!-- checks: written by `galewood verify --docs` -->", "<!-- end of checks -->")


def written_into(page: str, table: str) -> str:
    """The page with the table between its markers; ValueError where it has none."""
    begin, end = (page.find(marker) for marker in MARKERS)
    if not 0 <= begin < end:
        raise ValueError(f"the page has no lines {MARKERS[0]!r} and {MARKERS[1]!r}")
    return page[: begin + len(MARKERS[0])] + f"\n{table}\n" + page[end:]


def markdown(checks: list[Check]) -> str:
    """The table as docs/physics.md shows it."""
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
