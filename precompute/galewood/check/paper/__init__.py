"""The experiments of the paper, repeated on real trees."""

from galewood.check.paper.plan import PAPER_SPECIES, full_plan, quick_plan
from galewood.check.paper.run import run_paper

__all__ = ["PAPER_SPECIES", "full_plan", "quick_plan", "run_paper"]
