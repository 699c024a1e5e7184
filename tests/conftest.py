"""The longest files first, so that no process of a parallel run ends with one of them alone."""

import pytest

LONGEST = (
    "test_wheel", "test_accuracy", "test_build_end_to_end", "test_jobs", "test_leases", "test_verify_species",
    "test_paper", "test_evaluations", "test_evaluate", "test_api", "test_pipeline", "test_untrusted_uploads",
    "test_determinism",
)  # fmt: skip


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    def place(item: pytest.Item) -> int:
        name = item.path.stem
        return LONGEST.index(name) if name in LONGEST else len(LONGEST)

    items.sort(key=place)
