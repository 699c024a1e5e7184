"""Generated tree files in the styles that people upload, with the true label of every face.

The shapes, colours and proportions are drawn at random; nothing here knows the thresholds of the classifier.
"""

from dataclasses import dataclass

import numpy as np

from tests.precompute import labelled_crowns, labelled_scenes, labelled_sources
from tests.precompute.labelled_parts import STYLES
from tests.precompute.labelled_shapes import Shape
from tests.precompute.labelled_writers import write_glb, write_obj, write_ply, write_stl

REGISTERED = (labelled_crowns, labelled_scenes, labelled_sources)
"""Modules that add their styles to STYLES when they are imported."""


@dataclass
class LabelledFile:
    """A file, and the centre and label of each of its faces."""

    style: str
    filename: str
    data: bytes
    centres: np.ndarray
    labels: np.ndarray
    up: str


ROTATIONS = {
    "y": np.eye(3),
    "z": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
}


def labelled_file(name: str, seed: int) -> LabelledFile:
    """The file of a style, with random proportions."""
    make, kind, up = STYLES[name]
    rng = np.random.default_rng([seed, *name.encode()])
    parts = make(rng)
    for part in parts:
        part.shape = Shape(part.shape.vertices @ ROTATIONS[up].T, part.shape.faces, part.shape.uv)
    centres = np.concatenate([p.shape.vertices[p.shape.faces].mean(axis=1) for p in parts])
    labels = np.concatenate([np.full(len(p.shape.faces), p.label) for p in parts])
    write = {"glb": write_glb, "obj": write_obj, "ply": write_ply, "stl": write_stl}[kind]
    return LabelledFile(name, f"model.{kind}", write(parts), centres, labels, up)
