"""The glTF extension EXT_modal_dynamics (spec/formats/EXT_modal_dynamics.md) of a live tree."""

from __future__ import annotations

from typing import Any

from galewood.io.export.live.gusts import LiveGusts
from galewood.io.export.live.model import LiveModel

EXTENSION_NAME = "EXT_modal_dynamics"


def extension_of(model: LiveModel, gusts: LiveGusts) -> dict[str, Any]:
    """The extension of the asset: one model, and the wind it begins with."""
    rows = zip(model.step.tolist(), model.load.tolist(), model.drag.tolist(), strict=True)
    return {
        "models": [
            {
                "timeStep": model.dt_s,
                "oscillators": [{"step": step, "load": load, "drag": drag} for step, load, drag in rows],
                "pressure": {"exponent": model.exponent, "limit": model.most_pa},
                "wind": {
                    "velocity": list(gusts.wind_m_s),
                    "gustiness": gusts.gustiness,
                    "waves": [list(wave) for wave in gusts.waves],
                    "swing": list(gusts.swing),
                },
            }
        ]
    }
