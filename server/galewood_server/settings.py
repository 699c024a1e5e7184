"""Settings of the service, read from the environment (see docs/operations.md)."""

from __future__ import annotations

import os
import re
from ipaddress import ip_network
from pathlib import Path
from typing import Annotated, Literal

from galewood.constants import MOST_STREAMED_TREES
from galewood.packaged import data_folder, species_folder
from pydantic import AliasChoices, Field, field_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

PACKAGE = Path(__file__).resolve().parent
BYTES_PER_MEBIBYTE = 1024 * 1024
MOST_INDIVIDUALS = 4
TREES_PER_CORE = 12_000
"""Half of a core: a step and a frame of 20,000 trees take 28 ms (measured), and there are 30 per second."""


def default_workers() -> int:
    """Number of simulation worker processes: one per core, at least one."""
    return max(1, os.cpu_count() or 1)


def default_individuals() -> int:
    """Trees that are grown at once: each takes one core for some seconds, and 0.4 GB."""
    return min(MOST_INDIVIDUALS, default_workers())


def default_server_trees() -> int:
    """Trees that this machine steps at 30 Hz in half of its time; at least one forest of the largest size."""
    return max(MOST_STREAMED_TREES, TREES_PER_CORE * default_workers())


class Settings(BaseSettings):
    """All settings. The defaults suit a single laptop; names end in their units."""

    model_config = SettingsConfigDict(env_prefix="GALEWOOD_", extra="ignore", populate_by_name=True)

    host: str = Field(default="127.0.0.1", validation_alias=AliasChoices("GALEWOOD_HOST", "HOST"))
    port: int = Field(default=8000, ge=0, le=65535, validation_alias=AliasChoices("GALEWOOD_PORT", "PORT"))
    data_dir: Path = Path("data")
    database_url: str | None = None
    store_url: str | None = None
    scheduler_url: str | None = None
    page_dir: Path = data_folder("page", "web/dist", PACKAGE)
    species_dir: Path = species_folder()
    inventory: Path | None = None
    builtin_trees: bool = True

    workers: int = Field(default_factory=default_workers, ge=1, le=256)
    concurrent_jobs: int = Field(default=1, ge=1, le=64)
    concurrent_individuals: int = Field(default_factory=default_individuals, ge=1, le=64)
    concurrent_analyses: int = Field(default=1, ge=1, le=64)
    concurrent_evaluations: int = Field(default=1, ge=1, le=64)
    lease_s: float = Field(default=15.0, ge=1, le=3600)
    replaced_files_s: float = Field(default=600.0, ge=0)
    garbage_collection_s: float = Field(default=60.0, gt=0)
    job_attempts: int = Field(default=3, ge=1, le=20)
    job_stall_s: float = Field(default=1800.0, gt=0)
    prepare: bool = True
    job_module: str = "galewood_server.jobs.job_process"
    cluster_idle_s: float = Field(default=30.0, ge=0)

    upload_bytes: int = Field(default=64 * BYTES_PER_MEBIBYTE, ge=1024)
    import_memory_bytes: int = Field(default=3072 * BYTES_PER_MEBIBYTE, ge=256 * BYTES_PER_MEBIBYTE)
    import_cpu_s: int = Field(default=120, gt=0)
    import_wall_s: float = Field(default=1200.0, gt=0)
    concurrent_imports: int = Field(default=2, ge=1, le=64)

    concurrent_uploads: int = Field(default=16, ge=1, le=1024)
    stored_bytes: int = Field(default=20 * 1024 * BYTES_PER_MEBIBYTE, ge=0)
    free_bytes: int = Field(default=512 * BYTES_PER_MEBIBYTE, ge=0)

    # SHA-256 hashes (hex, comma-separated) of the keys with write access; empty: only local clients may write
    api_keys: Annotated[list[str], NoDecode] = Field(default_factory=list)
    local_writes: bool = True
    trusted_proxies: str = ""
    reads_per_minute: int = Field(default=6000, ge=0)
    writes_per_minute: int = Field(default=120, ge=0)
    connections: int = Field(default=4096, ge=1)
    requests_per_address: int = Field(default=256, ge=1)
    header_s: float = Field(default=10.0, gt=0)
    write_stall_s: float = Field(default=60.0, gt=0)
    body_stall_s: float = Field(default=10.0, gt=0)
    body_bytes_per_s: int = Field(default=16 * 1024, ge=0)
    shutdown_s: int = Field(default=5, ge=0)
    log_format: Literal["text", "json"] = "text"
    log_level: Literal["DEBUG", "INFO", "WARNING", "ERROR"] = "INFO"

    allowed_origins: list[str] = Field(default_factory=list)
    frame_ancestors: list[str] = Field(default_factory=list)
    socket_message_bytes: int = Field(default=4 * BYTES_PER_MEBIBYTE, ge=1024)
    socket_connections: int = Field(default=256, ge=1)
    socket_connections_per_address: int = Field(default=32, ge=1)
    socket_stall_s: float = Field(default=10.0, gt=0)
    socket_messages_per_s: float = Field(default=60.0, gt=0)
    socket_frames_per_s: float = Field(default=300.0, gt=0)
    socket_bytes_per_s: float = Field(default=1.0 * BYTES_PER_MEBIBYTE, gt=0)
    event_streams: int = Field(default=256, ge=1)
    event_streams_per_address: int = Field(default=32, ge=1)
    event_stream_idle_s: float = Field(default=1800.0, gt=0)
    forest_trees: int = Field(default=MOST_STREAMED_TREES, ge=1)
    forest_groups: int = Field(default=64, ge=1)
    server_trees: int = Field(default_factory=default_server_trees, ge=1)
    address_trees: int = Field(default=MOST_STREAMED_TREES, ge=1)
    address_trees_per_s: float = Field(default=10_000.0, gt=0)
    shared_forests: int = Field(default=64, ge=0)
    shared_forest_idle_s: float = Field(default=60.0, ge=0)
    # where other servers with the same database reach this one; unset: there are none
    peer_url: str | None = None

    @field_validator("api_keys", mode="before")
    @classmethod
    def _parse_hashes(cls, given: str | list[str]) -> list[str]:
        """A list of hashes from a comma-separated string. ValueError if one is not a SHA-256 in hex."""
        parts = given.split(",") if isinstance(given, str) else given
        hashes = [part.strip().lower() for part in parts if part.strip()]
        if not all(re.fullmatch(r"[0-9a-f]{64}", one) for one in hashes):
            raise ValueError(
                "expected SHA-256 hashes in hex, separated by commas; create them with `galewood key`"
            )
        return hashes

    @field_validator("trusted_proxies")
    @classmethod
    def _check_proxies(cls, given: str) -> str:
        """Addresses and networks, separated by commas, or "*" for all. ValueError for anything else."""
        for one in given.split(",") if given and given != "*" else ():
            try:
                ip_network(one.strip())
            except ValueError:
                raise ValueError("expected IP addresses or networks, separated by commas") from None
        return given

    @field_validator("peer_url")
    @classmethod
    def _check_peer_url(cls, given: str | None) -> str | None:
        """An origin, or nothing. ValueError for anything else."""
        if given and not re.fullmatch(r"https?://[A-Za-z0-9._-]+(:\d{1,5})?", given):
            raise ValueError('expected the address of this server such as "http://server-a:8000"')
        return given or None

    @field_validator("frame_ancestors")
    @classmethod
    def _check_ancestors(cls, given: list[str]) -> list[str]:
        """Origins, as they are written into a policy, also of all subdomains. ValueError otherwise."""
        if not all(re.fullmatch(r"https?://(\*\.)?[A-Za-z0-9.-]+(:\d{1,5})?|\*", one) for one in given):
            raise ValueError('expected origins such as "https://example.org", or "*" for all')
        return given

    @field_validator("allowed_origins")
    @classmethod
    def _check_origins(cls, given: list[str]) -> list[str]:
        """Whole origins, as browsers send them. ValueError for anything else."""
        if not all(re.fullmatch(r"https?://[a-z0-9.-]+(:\d{1,5})?|\*", one) for one in given):
            raise ValueError('expected origins in lower case such as "https://example.org", or "*" for all')
        return given

    @property
    def database(self) -> str:
        """SQLAlchemy URL: `database_url` if set, otherwise SQLite in the data folder."""
        return self.database_url or f"sqlite:///{self.data_dir.resolve() / 'galewood.sqlite'}"

    @property
    def cache_dir(self) -> Path:
        """Folder of intermediate results from which interrupted builds resume."""
        return self.data_dir.resolve() / "cache"

    @property
    def temporary_dir(self) -> Path:
        """Folder of temporary files, of uploads that are parsed among others; emptied by each start."""
        return self.data_dir.resolve() / "tmp"

    def cancel_flag(self, job_id: str) -> Path:
        """The file whose existence tells the workers that a job was cancelled."""
        return self.cache_dir / "cancelled" / job_id

    def light_copy(self, mesh_sha256: str) -> Path:
        """The light copy of the render mesh of an individual, on the server that has grown it."""
        return self.cache_dir / "light" / f"{mesh_sha256}.glb"

    @property
    def analyses_dir(self) -> Path:
        """Parent of the working folders of running evaluations."""
        return self.cache_dir / "analyses"

    def analysis_folder(self, job_id: str) -> Path:
        """Working folder of an evaluation: its finished runs, from which it resumes after a restart."""
        return self.analyses_dir / job_id

    def environment(self) -> dict[str, str]:
        """Environment variables from which a child process reads the same settings."""
        child = dict(os.environ)
        child["GALEWOOD_DATA_DIR"] = str(self.data_dir.resolve())
        child["GALEWOOD_DATABASE_URL"] = self.database
        child["GALEWOOD_WORKERS"] = str(self.workers)
        child["TMPDIR"] = str(self.temporary_dir)
        return child
