"""Colours of formats that store them as sRGB, as the linear values of glTF."""

from __future__ import annotations

import numpy as np

from galewood.formats.types import Material
from galewood.util import Floats


def linear_from_srgb(colours: Floats) -> Floats:
    """Linear values of sRGB values from 0 to 1 (IEC 61966-2-1); any further column is alpha and is kept."""
    colours = np.clip(np.asarray(colours, dtype=np.float64), 0.0, 1.0)
    rgb = colours[..., :3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return np.concatenate([linear, colours[..., 3:]], axis=-1)


def painted() -> Material:
    """A matt white material, which shows the colours of the vertices as they are."""
    return Material({"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}})
