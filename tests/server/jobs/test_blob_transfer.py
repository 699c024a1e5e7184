"""Blob transfer between servers and remote workers through a bucket (here a folder)."""

from __future__ import annotations

from pathlib import Path

import pytest
from galewood_server.jobs.artefact_publisher import ArtefactPublisher
from galewood_server.jobs.cluster.blob_transfer import BlobTransfer

from tests.server.jobs.test_artefact_publisher import Build


@pytest.fixture
def url(tmp_path: Path) -> str:
    return f"file://{tmp_path / 'bucket'}"


def test_another_server_of_a_job_reuses_its_tetrahedra(tmp_path: Path, url: str) -> None:
    """Regression test: a new mesh made all finished runs useless."""
    build = Build(tmp_path)
    publish = ArtefactPublisher(build.job_lease, build.stores, BlobTransfer(url, "job"))
    publish("tets-abc.npz", b"tetrahedra")
    BlobTransfer(url, "job").fetch_tetrahedra(tmp_path / "tets")
    assert (tmp_path / "tets" / "tets-abc.npz").read_bytes() == b"tetrahedra"
    BlobTransfer(url, "another").fetch_tetrahedra(tmp_path / "others")
    assert not list(tmp_path.glob("others/*"))


def test_a_finished_job_deletes_its_blobs(tmp_path: Path, url: str) -> None:
    transfer = BlobTransfer(url, "job")
    transfer.store_tetrahedra("tets-abc.npz", b"tetrahedra")
    transfer.delete_runs([])
    assert not [path for path in (tmp_path / "bucket").rglob("*") if path.is_file()]
