"""The runs of a table: winds, order, and which method each belongs to."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from galewood.check.verify.motion_checks import loaded_pole
from galewood.pipeline.sampling.plan import Samples, plan_samples, simulate
from galewood.pipeline.sampling.recording import DIRECTIONS_DEG, SampleWind, sample_winds
from galewood.pipeline.sampling.runner import SampleTask, TrajectoryRunner
from galewood.pipeline.sampling.training_winds import (
    GUST_WIND_COUNT,
    WIND_COUNT,
    gust_shapes,
    training_shapes,
)


def task(wind: SampleWind, folder: Path) -> SampleTask:
    return SampleTask(folder / "model", wind, (), folder / wind.name)


@pytest.fixture()
def samples(tmp_path: Path) -> Samples:
    default, paper = (
        [task(wind, tmp_path) for wind in some] for some in (training(), sample_winds(12.0, 1 / 30, 1.3))
    )
    return Samples(default, paper)


def training() -> list[SampleWind]:
    """Training winds whose speed is proportional to the sway that they shall cause."""
    shapes = [*training_shapes(0.6, 1 / 30, 1.3), *gust_shapes(1 / 30, 1.3)]
    return [shape.at(100 * shape.sway_share) for shape in shapes]


def recording_runner(events: list[str]) -> TrajectoryRunner:
    """A runner that creates empty files and records the names of their winds."""

    def runner(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        ready = [t for t in tasks if t.path.exists()]
        done(len(ready))
        for count, one in enumerate((t for t in tasks if not t.path.exists()), len(ready) + 1):
            one.path.touch()
            events.append(one.wind.name)
            done(count)
        return [t.path for t in tasks]

    return runner


def simulated_events(samples: Samples) -> list[str]:
    """The names of the winds that are run, in order."""
    events: list[str] = []
    shares: list[float] = []
    simulate(samples, recording_runner(events), shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    return events


def test_the_missing_runs_of_the_default_method_are_simulated(samples: Samples) -> None:
    for one in samples.default[::3]:
        one.path.touch()
    missing = [task.wind.name for task in samples.default if not task.path.exists()]
    assert simulated_events(samples) == missing
    assert simulated_events(samples) == []
    assert not any(task.path.exists() for task in samples.paper)


def test_the_default_method_has_no_recorded_states_and_some_gusts(samples: Samples) -> None:
    assert not [task.wind.name for task in samples.default if task.wind.recorded or task.wind.fade_frames]
    assert all(task.wind.recorded for task in samples.paper)
    assert not {task.path for task in samples.default} & {task.path for task in samples.paper}
    gusty = [task.wind.gusts.intensity > 0 for task in samples.default]
    assert gusty == [False] * WIND_COUNT + [True] * GUST_WIND_COUNT
    runs = (samples.default_runs(), samples.paper_runs())
    assert [len(each) for each in runs] == [WIND_COUNT + GUST_WIND_COUNT, 43]


def test_gusts_of_a_storm_may_bend_a_slender_tree_farther() -> None:
    shapes = gust_shapes(1 / 30, 1.3)
    assert max(shape.most_sway_share(25.0) for shape in shapes) == 0.45
    assert max(shape.most_sway_share(35.0) for shape in shapes) == 0.3
    uniform = training_shapes(0.6, 1 / 30, 1.3)
    assert all(shape.most_sway_share(speed) == shape.sway_share for shape in uniform for speed in (9.0, 50.0))


def test_the_runs_of_both_methods_are_planned_once(tmp_path: Path) -> None:
    model, points = loaded_pole(), np.arange(4)
    for all_winds, cosines in ((False, 18), (True, 36)):
        samples = plan_samples(model, 12.0, points, tmp_path, training(), frames=5, all_winds=all_winds)
        parts = [{task.path for task in some} for some in (samples.default, samples.paper)]
        assert [len(part) for part in parts] == [WIND_COUNT + GUST_WIND_COUNT, 1 + cosines + 6]
        assert len(set.union(*parts)) == sum(map(len, parts))


def test_the_recorded_winds_are_weak_medium_and_strong_in_all_directions(tmp_path: Path) -> None:
    samples = plan_samples(loaded_pole(), 12.0, np.arange(4), tmp_path, training(), frames=5)
    cosines = [task.wind for task in samples.paper if task.wind.name.startswith("cosine")]
    assert {(wind.name.split("-")[1], wind.direction_deg) for wind in cosines} == {
        (level, direction) for level in "135" for direction in DIRECTIONS_DEG
    }
