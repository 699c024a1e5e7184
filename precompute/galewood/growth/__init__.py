"""Individuals of the built-in species, grown by the generator in tools/species, which runs in Node."""

from galewood.growth.generator import GrowthError, find_generator, grow_files
from galewood.growth.skeleton import GrownSkeleton, read_skeleton

__all__ = [
    "GrownSkeleton",
    "GrowthError",
    "find_generator",
    "grow_files",
    "read_skeleton",
]
