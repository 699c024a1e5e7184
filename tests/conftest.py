"""Order of the tests, and which of them `make test` leaves to `make test-long`."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from galewood.threads import SINGLE_THREADED

# As in the service: the tests run in one process per core. numpy reads these variables when it is loaded.
os.environ.update(SINGLE_THREADED)

from galewood.util import worker_pool

LONG_FILES = (
    "test_model_file", "test_mujoco_figures", "test_snippets", "test_pipeline", "test_wheel",
    "test_event_loop", "test_api", "test_structure", "test_radius_correction", "test_paper",
    "test_calibration", "test_untrusted_uploads", "test_verify_planted", "test_peers", "test_field",
    "test_stop", "test_verify_species", "test_motion_command", "test_determinism", "test_bench_serve",
    "test_evaluate", "test_skeleton", "test_wind_statistics", "test_support", "test_openapi",
    "test_evaluations", "test_guarded_process", "test_foundation", "test_candidates", "test_start_failures",
    "test_mesh_untrusted_text", "test_stalls_and_damage", "test_leases", "test_outline",
    "test_shipped_trees", "test_corpus", "test_piece_choices", "test_shown_names", "test_conversions",
    "test_socket_fuzz", "test_open_connections", "test_doctor", "test_mesh_formats_hostile",
    "test_container_scripts", "test_damaged_rows", "test_confinement", "test_event_streams",
    "test_mesh_import_process", "test_mesh_nesting", "test_client", "test_generated_client",
    "test_untrusted_results", "test_dependencies", "test_release", "test_pulled_pole",
)  # fmt: skip
"""Files of `make test-long`, the longest first: no process of a parallel run ends with one of them alone."""
PARTLY_LONG_FILES = (
    "test_build_end_to_end", "test_accuracy", "test_jobs", "test_packs", "test_drawn", "test_labelled_trees",
    "test_evidence", "test_mjcf",
)  # fmt: skip
"""Files with tests of both `make test` and `make test-long`. They begin first in either."""


@pytest.fixture(scope="module")
def one_worker() -> Iterator[None]:
    """Builds of the module have one worker process, and only if they find work for it.

    To load a second one, or one that only waits, takes longer than the runs of a small tree.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker_pool, "usable_cores", lambda: 1)
        patch.setattr("galewood.pipeline.stages.build.WARM_MODULES", ())
        yield


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Where no long tests are wanted, their files are not even imported, which every process would do."""
    unwanted = "not long" in str(config.getoption("markexpr")) and collection_path.stem in LONG_FILES
    return True if unwanted else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    order = [*PARTLY_LONG_FILES, *LONG_FILES]

    def place(item: pytest.Item) -> int:
        name = item.path.stem
        return order.index(name) if name in order else len(order)

    items.sort(key=place)
    for item in items:
        if item.path.stem in LONG_FILES:
            item.add_marker("long")
