"""Order of the tests, and which of them `make test-fast` leaves out."""

import os
from collections.abc import Iterator

import pytest
from galewood.threads import SINGLE_THREADED

# As in the service: the tests run in one process per core. numpy reads these variables when it is loaded.
os.environ.update(SINGLE_THREADED)

from galewood.util import worker_pool

LONGEST = (
    "test_wheel", "test_build_end_to_end", "test_accuracy", "test_verify_planted", "test_jobs", "test_leases",
    "test_verify_species", "test_paper", "test_evaluations", "test_evaluate", "test_api", "test_pipeline",
    "test_untrusted_uploads", "test_determinism", "test_snippets",
)  # fmt: skip
"""The longest files come first, so that no process of a parallel run ends with one of them alone."""
SLOW = {
    *LONGEST, "test_openapi", "test_wind_statistics", "test_corpus", "test_tetrahedra",
    "test_bench", "test_field",
}  # fmt: skip
"""Files that build a tree or simulate for long."""
SLOW_FIXTURES = {"start_server", "server", "api"}


@pytest.fixture(scope="module")
def one_worker() -> Iterator[None]:
    """Builds of the module have one worker process, and only if they find work for it.

    To load a second one, or one that only waits, takes longer than the runs of a small tree.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker_pool, "usable_cores", lambda: 1)
        patch.setattr("galewood.pipeline.build.WARM_MODULES", ())
        yield


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    def place(item: pytest.Item) -> int:
        name = item.path.stem
        return LONGEST.index(name) if name in LONGEST else len(LONGEST)

    items.sort(key=place)
    for item in items:
        if item.path.stem in SLOW or SLOW_FIXTURES & set(getattr(item, "fixturenames", ())):
            item.add_marker("slow")
