"""Training runs; in: a FemModel and winds; out: snapshots of motion and state, one file per run.

All names but the seed are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.sampling.design_speed import MAX_SWAY_SHARE, DesignWind, design_wind
    from galewood.sampling.plan import Samples, plan_samples, simulate
    from galewood.sampling.recording import (
        ALL_COSINES,
        COSINE_PREFIX,
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
    from galewood.sampling.training_winds import (
        FURTHER_WINDS,
        GOLDEN_RAD,
        STRONGEST_M_S,
        WIND_COUNT,
        WindShape,
        noise,
        training_shapes,
    )

__getattr__ = lazily(
    __name__,
    {
        "MAX_SWAY_SHARE": "galewood.sampling.design_speed",
        "DesignWind": "galewood.sampling.design_speed",
        "design_wind": "galewood.sampling.design_speed",
        "Samples": "galewood.sampling.plan",
        "plan_samples": "galewood.sampling.plan",
        "simulate": "galewood.sampling.plan",
        "ALL_COSINES": "galewood.sampling.recording",
        "COSINE_PREFIX": "galewood.sampling.recording",
        "DIRECTIONS_DEG": "galewood.sampling.recording",
        "SampledRun": "galewood.sampling.recording",
        "SampleWind": "galewood.sampling.recording",
        "Trajectory": "galewood.sampling.recording",
        "read_trajectory": "galewood.sampling.recording",
        "sample_trajectory": "galewood.sampling.recording",
        "sample_winds": "galewood.sampling.recording",
        "SampleTask": "galewood.sampling.runner",
        "TrajectoryRunner": "galewood.sampling.runner",
        "content_hash": "galewood.sampling.runner",
        "run_in_processes": "galewood.sampling.runner",
        "run_task": "galewood.sampling.runner",
        "sample_tasks": "galewood.sampling.runner",
        "FURTHER_WINDS": "galewood.sampling.training_winds",
        "GOLDEN_RAD": "galewood.sampling.training_winds",
        "STRONGEST_M_S": "galewood.sampling.training_winds",
        "WIND_COUNT": "galewood.sampling.training_winds",
        "WindShape": "galewood.sampling.training_winds",
        "noise": "galewood.sampling.training_winds",
        "training_shapes": "galewood.sampling.training_winds",
    },
)
__all__ = [
    "ALL_COSINES",
    "COSINE_PREFIX",
    "DIRECTIONS_DEG",
    "FURTHER_WINDS",
    "GOLDEN_RAD",
    "MAX_SWAY_SHARE",
    "STRONGEST_M_S",
    "WIND_COUNT",
    "DesignWind",
    "SampleTask",
    "SampleWind",
    "SampledRun",
    "Samples",
    "Trajectory",
    "TrajectoryRunner",
    "WindShape",
    "content_hash",
    "design_wind",
    "noise",
    "plan_samples",
    "read_trajectory",
    "run_in_processes",
    "run_task",
    "sample_tasks",
    "sample_trajectory",
    "sample_winds",
    "simulate",
    "training_shapes",
]
