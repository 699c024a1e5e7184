"""The same tetrahedra, settings and seed give bit-identical samples in every process."""

import hashlib
import subprocess
import sys
from pathlib import Path

from galewood.check.verify.specimens import TARGETS
from galewood.pipeline.sampling.design_speed import design_wind
from galewood.pipeline.sampling.recording import sample_trajectory, sample_winds
from galewood.pipeline.sampling.training_winds import training_shapes
from galewood.solid.fem.dynamics import Simulator
from galewood.solid.fem.model import FemSettings
from galewood.solid.model.construction import build_model
from galewood.solid.skeleton.extraction import sampled_elements

from tests.precompute.fixtures.apricot import apricot

FRAMES = 12


def digest() -> str:
    """Hash of a model of the apricot and of its runs under two winds."""
    one = apricot(TARGETS[0])
    model = build_model(one.mesh, one.skeleton, one.wood, one.lumped, FemSettings())
    simulator = Simulator(model)
    dt_s = model.settings.dt_s
    exponent = model.streamlined_exponent
    speed_m_s = design_wind(simulator, 18.0, one.tree.height_m, dt_s, exponent).speed_m_s
    points = one.mesh.tets[sampled_elements(one.mesh, one.skeleton, 35)].ravel()
    found = hashlib.sha256()
    for part in (model.blocks, model.mass_kg, model.prestress):
        found.update(part.tobytes())
    sampled = sample_winds(speed_m_s, dt_s, exponent, FRAMES)[5]
    for wind in (sampled, training_shapes(1.0, dt_s, exponent)[0].at(speed_m_s)):
        run = sample_trajectory(simulator, wind, points, dt_s)
        for part in (run.displacement_m, run.velocity, run.force, run.stiffness):
            found.update(part.tobytes())
    return found.hexdigest()


def test_samples_are_bit_identical_in_every_process():
    command = [
        sys.executable,
        "-c",
        "from tests.precompute.pipeline.test_determinism import digest; print(digest())",
    ]
    other = subprocess.Popen(
        command, cwd=Path(__file__).parents[3], stdout=subprocess.PIPE, text=True, env=None
    )
    assert digest() == other.communicate()[0].strip()
