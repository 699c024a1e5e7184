"""The estimate of the remaining time of a job."""

import pytest
from galewood_server.jobs.progress import USUAL_S, seconds_left


@pytest.mark.parametrize("fraction", [0.0, 0.05, 0.5, 0.95])
def test_it_is_exact_for_work_at_the_usual_speed(fraction: float) -> None:
    assert seconds_left(USUAL_S * fraction, fraction, fraction) == pytest.approx(USUAL_S * (1 - fraction))


@pytest.mark.parametrize("whole_s", [10.0, 600.0])
def test_it_lies_between_the_usual_and_the_observed_speed_and_tends_to_that(whole_s: float) -> None:
    errors: list[float] = []
    for fraction in (0.05, 0.3, 0.6, 0.9):
        left_s = whole_s * (1 - fraction)
        estimate_s = seconds_left(whole_s * fraction, fraction, fraction)
        assert min(left_s, USUAL_S * (1 - fraction)) < estimate_s < max(left_s, USUAL_S * (1 - fraction))
        errors.append(abs(estimate_s - left_s) / left_s)
    assert errors == sorted(errors, reverse=True)


def test_a_job_that_continues_is_judged_by_what_it_has_done_since() -> None:
    """A restarted job of the usual speed starts at 0.6: what was done before takes no time now."""
    assert seconds_left(0.2 * USUAL_S, 0.2, 0.8) == pytest.approx(0.2 * USUAL_S)
