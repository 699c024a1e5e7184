"""Training runs; in: a FemModel and winds; out: snapshots of motion and state, one file per run."""

from galewood.sampling.design_speed import MAX_SWAY_SHARE, DesignWind, design_wind
from galewood.sampling.plan import Samples, default_winds, planned, simulate
from galewood.sampling.recording import (
    ALL_COSINES,
    COSINE,
    DIRECTIONS_DEG,
    SampledRun,
    SampleWind,
    Trajectory,
    read_trajectory,
    sample_trajectory,
    sample_winds,
)
from galewood.sampling.runner import (
    SampleTask,
    TrajectoryRunner,
    content_hash,
    run_in_processes,
    run_task,
    sample_tasks,
)
from galewood.sampling.training_winds import GOLDEN_RAD, SEED, noise

__all__ = [
    "ALL_COSINES",
    "COSINE",
    "DIRECTIONS_DEG",
    "GOLDEN_RAD",
    "MAX_SWAY_SHARE",
    "SEED",
    "DesignWind",
    "SampleTask",
    "SampleWind",
    "SampledRun",
    "Samples",
    "Trajectory",
    "TrajectoryRunner",
    "content_hash",
    "default_winds",
    "design_wind",
    "noise",
    "planned",
    "read_trajectory",
    "run_in_processes",
    "run_task",
    "sample_tasks",
    "sample_trajectory",
    "sample_winds",
    "simulate",
]
