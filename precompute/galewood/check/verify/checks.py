"""A verification check: exact value, computed value, deviation, limit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Check:
    """One row of the table. `deviation` is relative, or absolute where the exact value is zero."""

    name: str
    exact: float | None
    computed: float | None
    unit: str
    deviation: float | None
    limit: float
    note: str = ""

    @property
    def skipped(self) -> bool:
        """Whether the check could not run (its note gives the reason)."""
        return self.computed is None

    @property
    def passed(self) -> bool:
        """Whether the deviation is within its limit; a skipped check counts as passed."""
        return self.skipped or (self.deviation is not None and abs(self.deviation) <= self.limit)

    @property
    def state(self) -> str:
        """ "passed", "FAILED" or "skipped"."""
        return "skipped" if self.skipped else "passed" if self.passed else "FAILED"

    def line(self) -> str:
        """Format the check as one line of text."""
        deviation = "" if self.deviation is None else f", off {self.deviation:.2g} of {self.limit:g}"
        note = f" ({self.note})" if self.note else ""
        return f"{self.state}: {self.name}{deviation}{note}"


def relative(name: str, exact: float, computed: float, unit: str, limit: float, note: str = "") -> Check:
    """Check a value against a nonzero exact value; the limit is relative."""
    deviation = computed / exact - 1
    return Check(
        name=name, exact=exact, computed=computed, unit=unit, deviation=deviation, limit=limit, note=note
    )


def absolute(name: str, computed: float, limit: float, note: str = "") -> Check:
    """Check a ratio that is zero in the exact solution; the limit is absolute."""
    return Check(
        name=name, exact=0.0, computed=computed, unit="–", deviation=computed, limit=limit, note=note
    )


def skipped(name: str, why: str) -> Check:
    """A check that cannot run, with the reason."""
    return Check(name=name, exact=None, computed=None, unit="–", deviation=None, limit=0.0, note=why)
