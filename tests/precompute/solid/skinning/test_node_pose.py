"""The rotation of a node carries no stretch of its link."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.solid.skinning.node_poses import limit_stretch, turned


@pytest.mark.parametrize("angle", [0.1, 0.5, 0.9])
def test_a_linear_motion_is_drawn_at_its_angle(angle: float) -> None:
    rest = np.array([(0.0, 0.0, 0.0), (0.0, 2.0, 0.0)])
    moved = np.array([(0.0, 0.0, 0.0), (2 * np.tan(angle), 0.0, 0.0)])
    shortened, stretch = limit_stretch(rest, np.array([0, 0]), moved)
    sine = np.tan(angle) / stretch[1]
    assert sine == pytest.approx(np.sin(angle))
    assert np.linalg.norm(rest[1] + shortened[1]) == pytest.approx(
        2 * 1.02 if angle > 0.2 else 2 / np.cos(angle)
    )
    drawn = turned(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -sine]))
    assert np.arctan2(drawn[0], drawn[1]) == pytest.approx(angle, abs=0.12 * angle**2 + 1e-3)
