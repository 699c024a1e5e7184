"""Speed and memory of every stage, as ratios to other programs where there are any."""

from galewood.bench.report import sentences
from galewood.bench.run import PARTS, run_bench

__all__ = ["PARTS", "run_bench", "sentences"]
