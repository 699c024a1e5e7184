"""Individuals of the built-in species, grown by the generator in tools/species, which runs in Node."""

from galewood.growth.generator import GrowthError, grow_files
from galewood.growth.skeleton import GrownSkeleton, read_skeleton

__all__ = ["GrownSkeleton", "GrowthError", "grow_files", "read_skeleton"]
