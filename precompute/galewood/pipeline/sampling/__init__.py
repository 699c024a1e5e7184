"""Training runs; in: a FemModel and winds; out: snapshots of motion and state, one file per run.

All names but the seed are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.pipeline.sampling.design_speed import MAX_SWAY_SHARE, DesignWind, design_wind
    from galewood.pipeline.sampling.plan import Samples, plan_samples, simulate
    from galewood.pipeline.sampling.recording import (
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
    from galewood.pipeline.sampling.runner import (
        SampleTask,
        TrajectoryRunner,
        content_hash,
        run_in_processes,
        run_task,
        sample_tasks,
    )
    from galewood.pipeline.sampling.training_winds import (
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
        "MAX_SWAY_SHARE": "galewood.pipeline.sampling.design_speed",
        "DesignWind": "galewood.pipeline.sampling.design_speed",
        "design_wind": "galewood.pipeline.sampling.design_speed",
        "Samples": "galewood.pipeline.sampling.plan",
        "plan_samples": "galewood.pipeline.sampling.plan",
        "simulate": "galewood.pipeline.sampling.plan",
        "ALL_COSINES": "galewood.pipeline.sampling.recording",
        "COSINE_PREFIX": "galewood.pipeline.sampling.recording",
        "DIRECTIONS_DEG": "galewood.pipeline.sampling.recording",
        "SampledRun": "galewood.pipeline.sampling.recording",
        "SampleWind": "galewood.pipeline.sampling.recording",
        "Trajectory": "galewood.pipeline.sampling.recording",
        "read_trajectory": "galewood.pipeline.sampling.recording",
        "sample_trajectory": "galewood.pipeline.sampling.recording",
        "sample_winds": "galewood.pipeline.sampling.recording",
        "SampleTask": "galewood.pipeline.sampling.runner",
        "TrajectoryRunner": "galewood.pipeline.sampling.runner",
        "content_hash": "galewood.pipeline.sampling.runner",
        "run_in_processes": "galewood.pipeline.sampling.runner",
        "run_task": "galewood.pipeline.sampling.runner",
        "sample_tasks": "galewood.pipeline.sampling.runner",
        "FURTHER_WINDS": "galewood.pipeline.sampling.training_winds",
        "GOLDEN_RAD": "galewood.pipeline.sampling.training_winds",
        "STRONGEST_M_S": "galewood.pipeline.sampling.training_winds",
        "WIND_COUNT": "galewood.pipeline.sampling.training_winds",
        "WindShape": "galewood.pipeline.sampling.training_winds",
        "noise": "galewood.pipeline.sampling.training_winds",
        "training_shapes": "galewood.pipeline.sampling.training_winds",
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
