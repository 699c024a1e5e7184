"""Speed and memory of every stage, as ratios to other programs where there are comparable ones."""

from galewood.check.bench.report import sentences
from galewood.check.bench.run import chosen_parts, run_bench

__all__ = ["chosen_parts", "run_bench", "sentences"]
