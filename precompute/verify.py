"""The physics checks that `galewood verify` runs: exact value, computed value, deviation, limit."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
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


def verify_table(tell: Callable[[Check], None] = lambda check: None) -> list[Check]:
    """Run every check; `tell` hears of each as it ends."""
    from precompute import verify_beams, verify_elements, verify_motion

    found: list[Check] = []
    groups: list[Callable[[], Iterator[Check]]] = [
        verify_elements.checks,
        verify_beams.checks,
        verify_motion.checks,
    ]
    for group in groups:
        for check in group():
            found.append(check)
            tell(check)
    return found


def run_checks(tell: Callable[[Check], None] = lambda check: None) -> dict[str, Any]:
    """All checks as JSON-able figures: whether all passed, seconds, and the lines."""
    begin = perf_counter()
    checks = verify_table(tell)
    return {
        "passed": all(check.passed for check in checks),
        "seconds": perf_counter() - begin,
        "checks": [{**asdict(check), "passed": check.passed, "skipped": check.skipped} for check in checks],
    }


def markdown(checks: list[Check]) -> str:
    """The table as docs/physics.md shows it."""
    lines = ["| check | exact | computed | deviation | limit | |", "|---|---|---|---|---|---|"]
    for check in checks:
        state = "skipped" if check.skipped else "passed" if check.passed else "FAILED"
        exact, computed = (_figure(value, check.unit) for value in (check.exact, check.computed))
        deviation = "" if check.deviation is None else f"{check.deviation:.2g}"
        note = f"; {check.note}" if check.note else ""
        lines.append(
            f"| {check.name} | {exact} | {computed} | {deviation} | {check.limit:g} | {state}{note} |"
        )
    return "\n".join(lines)


def _figure(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.5g} {unit}".removesuffix(" –")
