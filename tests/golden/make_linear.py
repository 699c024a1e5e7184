"""Golden table of linear oscillators, as a table of beams: every mode is an oscillator, none is coupled.

python -m tests.golden.make_linear
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
from galewood.motion.modal import force_terms, shape_terms
from galewood.table import Table, decode, encode

from tests.golden import GOLDEN_FOLDER
from tests.golden.make import sway_steps

LEFT_OUT = ["large deflections", "streamlining"]


def linear_table(table: Table) -> Table:
    """The oscillators of a table without couplings, without further modes and without records."""
    d = len(table.modal_step)
    provenance = {**table.metadata["provenance"], "preliminary": True, "left_out": LEFT_OUT}
    return replace(
        table,
        metadata={**table.metadata, "modes": d, "provenance": provenance},
        mode_scale=table.mode_scale[:d],
        node_basis=np.ascontiguousarray(table.node_basis[:, :, :d]),
        node_turn=np.ascontiguousarray(table.node_turn[:, :, :d]),
        modal_force=np.zeros((force_terms(0), d), np.float32),
        modal_pose=np.zeros((d + 2 + shape_terms(0), 0), np.float32),
        modal_limits=table.modal_limits[:3],
        paper=None,
    )


def main() -> None:
    table = linear_table(decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes()))
    (GOLDEN_FOLDER / "pole-linear.safetensors").write_bytes(encode(table))
    text = json.dumps(sway_steps(table), separators=(",", ":"))
    (GOLDEN_FOLDER / "sway-linear.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
