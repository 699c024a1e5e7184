"""The order of the runs of a table: the first few make an early one."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from galewood.sampling.plan import Samples, simulate
from galewood.sampling.recording import SampleWind, sample_winds
from galewood.sampling.runner import SampleTask, TrajectoryRunner
from galewood.sampling.training_winds import further_winds, training_winds


def task(wind: SampleWind, folder: Path) -> SampleTask:
    return SampleTask(folder / "model", wind, (), folder / wind.name)


@pytest.fixture()
def samples(tmp_path: Path) -> Samples:
    recorded = [task(wind, tmp_path) for wind in sample_winds(12.0, 1 / 30)]
    training, further = (
        [task(wind, tmp_path) for wind in winds(12.0, 1 / 30)] for winds in (training_winds, further_winds)
    )
    return Samples(recorded, training, further)


def touching(happened: list[str]) -> TrajectoryRunner:
    """A runner that makes empty files and notes whose."""

    def runner(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        ready = [t for t in tasks if t.path.exists()]
        done(len(ready))
        for count, one in enumerate((t for t in tasks if not t.path.exists()), len(ready) + 1):
            one.path.touch()
            happened.append(one.wind.name)
            done(count)
        return [t.path for t in tasks]

    return runner


def play(samples: Samples) -> list[str]:
    """What happens in turn: winds that are run, and the early table."""
    happened: list[str] = []
    shares: list[float] = []
    simulate(samples, touching(happened), shares.append, lambda: happened.append("early"))
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    return happened


def test_the_first_runs_come_first_and_the_early_table_after_them(samples: Samples) -> None:
    first, all_winds = samples.first(), {wind.name for wind in samples.winds}
    happened = play(samples)
    assert happened.count("early") == 1
    at = happened.index("early")
    assert set(happened[:at]) == {wind.name for wind in first.winds}
    assert set(happened) - {"early"} == all_winds
    assert play(samples) == []


def test_a_build_that_goes_on_has_its_early_table_at_once(samples: Samples) -> None:
    for one in (*samples.first().recorded, *samples.first().training):
        one.path.touch()
    assert play(samples)[0] == "early"


def test_the_first_winds_come_from_all_sides_and_in_all_strengths(samples: Samples) -> None:
    first = samples.first()
    frames = sum(len(wind.pressure_pa) for wind in first.winds)
    assert frames < 0.4 * sum(len(wind.pressure_pa) for wind in samples.winds)
    cosine = [wind for wind in first.winds if wind.name.startswith("cosine")]
    total = np.sum([wind.pressure_pa.sum(axis=0) for wind in cosine], axis=0)
    assert np.linalg.norm(total) < 1e-6 * np.abs(cosine[0].pressure_pa).sum()
    assert len({np.linalg.norm(wind.pressure_pa, axis=1).max().round(6) for wind in cosine}) == 3
    assert any(wind.fade_frames for wind in first.winds)
    assert any(wind.name.startswith("learn-noise") for wind in first.winds)
    assert any(wind.name.startswith("learn-gust") for wind in first.winds)


def test_what_moves_freely_is_learnt_and_what_was_faded_is_not(samples: Samples) -> None:
    names = [Path(run.path).name for run in samples.training_runs()]  # type: ignore[attr-defined]
    assert not [name for name in names if name.startswith("gust")]
    assert len(names) == 1 + 36 + 20


def test_further_winds_are_run_when_asked_for_and_not_before(samples: Samples) -> None:
    further = {task.wind.name for task in samples.further}
    assert not further & set(play(samples))
    happened: list[str] = []
    shares: list[float] = []
    runs = samples.further_runs(touching(happened), shares.append)
    assert set(happened) == further
    assert len(happened) == len(runs) == 48
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
