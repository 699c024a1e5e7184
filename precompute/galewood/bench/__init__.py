"""Speed and memory of every stage, as ratios to other programs where there are comparable ones."""

from galewood.bench.report import sentences
from galewood.bench.run import PARTS, chosen_parts, run_bench

__all__ = ["PARTS", "chosen_parts", "run_bench", "sentences"]
